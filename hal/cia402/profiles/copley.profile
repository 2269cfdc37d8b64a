# Copley Controls on CANopen. Vendor number ABh: as public EtherCAT programs have it.
# Mapping is refused while 1600:00 or 1A00:00 is not 0, with 06010000h (canopen-python/canopen#3): the set-up's order.
# Not verified: the unit of 6075 (mA in the standard; "CANopen Programmer's Manual" 16-01195 could not be read), values of
# 6007, 605A, 605E. No drive was at hand.
name = Copley Controls
vendor = 0xAB
note = compare the rated current said below with the motor's, because the unit of 6075 was not verified for this maker
