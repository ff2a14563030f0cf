#ifndef ICDGEN_H
#define ICDGEN_H

/**
 * @file
 * What all generated messages share. Users need only icd_status_t; everything else is for the generated code.
 *
 * ICDGEN_NO_DOUBLE  define it to leave out everything that needs floating-point arithmetic. Floating-point fields are
 *                   still there, moved as bits.
 * ICDGEN_PORTABLE   define it to use nothing but C: no byte order, word access or built-in of the compiler is assumed.
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
