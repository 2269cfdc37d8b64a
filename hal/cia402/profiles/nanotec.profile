# Nanotec N5, PD4, C5-E and others on CANopen.
# Object dictionary of N5 and PD4-E: 6075 shows 203B:01 in mA, 6071, 6072 and 6077 are thousandths of it, the smaller of
# 6072 and 6073 limits 6071, 6072 is 0 from the factory (no torque), 607E reverses positions, 60C2:02 takes -3 only.
# Vendor number 26Ch: as public EtherCAT programs for PD4-E have it.
# Not verified: values of 6007, 605A, 605E. No drive was at hand.
name = Nanotec
vendor = 0x26C
note = 6072 is 0 from the factory: set it with the maker's tool if it is refused
