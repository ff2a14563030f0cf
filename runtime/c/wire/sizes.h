#ifndef ICDGEN_WIRE_SIZES_H
#define ICDGEN_WIRE_SIZES_H

/** Size in bytes of the longest message in a procedure of any node. */
#define ICD_STEP_BYTES 8u

/** Largest number of registers of a procedure of any node. */
#define ICD_REGISTERS 8u

#endif /* ICDGEN_WIRE_SIZES_H */
