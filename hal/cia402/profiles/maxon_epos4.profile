# maxon EPOS4 on CANopen. Vendor number: 251 in the maker's EtherCAT slave information of EPOS4.
# 3001:01 nominal current (UNSIGNED32, mA), 3001:05 torque constant: as public programs for EPOS4 write them.
# Not verified: that 6075 is missing, that 6071 and 6077 are thousandths of the torque at 3001:01 (rated torque 6076
# = nominal current times torque constant), which objects options 6007, 605A, 605E take. No drive was at hand.
name = maxon EPOS4
vendor = 0xFB
rated_current = 3001:01 4
note = rated current is read from 3001:01; check that 6076 is 3001:01 times 3001:05
