#ifndef ICDGEN_WIRE_LINKAGE_H
#define ICDGEN_WIRE_LINKAGE_H

#ifndef ICDGEN_SHARED
#define ICDGEN_API static inline
#elif defined(__cplusplus)
#define ICDGEN_API extern "C"
#else
#define ICDGEN_API extern
#endif

#endif /* ICDGEN_WIRE_LINKAGE_H */
