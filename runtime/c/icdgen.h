#ifndef ICDGEN_H
#define ICDGEN_H

/**
 * @file
 * Common part of all generated messages. Applications need only icd_status_t; everything else is used by the
 * generated code.
 *
 * Macros that may be defined before this header is included:
 *
 * ICDGEN_NO_DOUBLE  Leave out everything that needs floating-point arithmetic. Floating-point fields remain and are
 *                   copied as bits.
 * ICDGEN_PORTABLE   Use standard C only. Nothing is assumed about byte order, unaligned access or compiler built-ins.
 */

#include "support/base.h"

#include "support/words.h"

#include "support/bits.h"

#include "support/rows.h"

#include "support/physical.h"

#include "support/curve.h"

#include "support/derived.h"

#include "support/text.h"

#include "support/field.h"

#endif /* ICDGEN_H */
