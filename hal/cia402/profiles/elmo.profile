# Elmo SimplIQ and Gold on CANopen. Vendor number 9Ah: as public EtherCAT configurations of Gold drives have it.
# "CANopen DSP 402 Implementation Guide" (MAN-CAN402IG 1.2): 6075 is the rated current in mA (CL[1]); 6072 acts as 6073 does
# (PL[1]), both in thousandths of the rated one, and 6071 is converted through 6075.
# Not verified: defaults and values of 6007, 605A, 605E and 607E in Gold's firmware. No drive was at hand.
name = Elmo SimplIQ or Gold
vendor = 0x9A
note = no quirk is known to this firmware, and no drive of this maker was tried
