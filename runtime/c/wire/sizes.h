#ifndef ICDGEN_WIRE_SIZES_H
#define ICDGEN_WIRE_SIZES_H

/** Bytes of the longest message that takes part in a procedure, of any node. */
#define ICD_STEP_BYTES 8u

#endif /* ICDGEN_WIRE_SIZES_H */
