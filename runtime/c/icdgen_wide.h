#ifndef ICDGEN_WIDE_H
#define ICDGEN_WIDE_H

/**
 * @file
 * Physical values whose scale has more digits than icdgen.h supports. Everything here is used by the generated code.
 */

#include "icdgen.h"

#include "support/wide.h"

#endif /* ICDGEN_WIDE_H */
