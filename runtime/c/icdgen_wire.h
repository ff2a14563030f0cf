#ifndef ICDGEN_WIRE_H
#define ICDGEN_WIRE_H

/**
 * @file
 * Wire layer: transport of messages over UART, I2C and CAN, checksums, clients, procedures and logs.
 *
 * The functions perform no input or output: the application passes received bytes in, and takes bytes to send and
 * events out. They do not open ports, sleep, read a clock or allocate memory. The application provides all buffers and
 * the current time `now` in milliseconds, which may wrap around. NODE_link() returns the description of a protocol.
 *
 * Macros that may be defined before this header is included:
 *
 * ICDGEN_SHARED     For programs of several source files: declare the functions only. Compile icdgen_wire.c and
 *                   NODE/link.c once and link them. Otherwise, each source file gets its own static copy.
 * ICDGEN_NO_TABLES  Compute CRCs without lookup tables: slower, but saves up to 512 bytes per CRC. With -Os, there are
 *                   none unless ICDGEN_TABLES is defined.
 * ICDGEN_NO_FILES   Leave out procedures, such as the transfer of files. Their functions return ICD_ERROR_UNSUPPORTED.
 * ICDGEN_NO_LOGS    Leave out logs. Do not define it if the node sends unsolicited logs.
 * ICDGEN_MOST_AWAITED
 *                   Largest number of requests whose responses a client awaits or that may still arrive late, 8 unless
 *                   it is defined. Each takes 36 bytes of a client.
 * NODE_CHOSEN       Leave out all messages in the tables of NODE/link.c, except those for which NODE_WITH_MESSAGE is
 *                   defined and those that the wire layer itself needs.
 */

#include "icdgen.h"

#include "wire/linkage.h"

#include "wire/forms.h"

#include "wire/stream_form.h"

#include "wire/kinds.h"

#include "wire/procedure_forms.h"

#include "wire/link.h"

#include "wire/events.h"

#include "wire/crc.h"

#include "wire/checksum.h"

#include "wire/uart.h"

#include "wire/stream.h"

#include "wire/i2c.h"

#include "wire/can.h"

#include "wire/can_join.h"

#include "wire/log.h"

#include "wire/time.h"

#include "wire/files.h"

#include "wire/client.h"

#include "wire/sizes.h"

#include "wire/procedure.h"

#ifndef ICDGEN_SHARED
#include "icdgen_wire.c"
#endif

#endif /* ICDGEN_WIRE_H */
