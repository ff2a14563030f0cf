#ifndef ICDGEN_WIDE_H
#define ICDGEN_WIDE_H

/**
 * @file
 * Physical values whose formula has numbers of more digits than icdgen.h computes with. Everything here is for the
 * generated code.
 */

#include "icdgen.h"

#include "support/wide.h"

#endif /* ICDGEN_WIDE_H */
