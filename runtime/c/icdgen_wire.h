#ifndef ICDGEN_WIRE_H
#define ICDGEN_WIRE_H

/**
 * @file
 * How messages travel: UART, I2C, CAN, checksums, a client, file transfer, logs. Nothing here opens a port, sleeps,
 * looks at a clock or allocates: bytes go in, bytes and events come out, memory and time (milliseconds, which may wrap)
 * are the caller's. What differs from node to node is in its link, which NODE_link() of its header gives.
 *
 * ICDGEN_SHARED     define it where the program has several units: this header declares the functions then, and
 *                   icdgen_wire.c and NODE/link.c are compiled once. Else each unit has those that it uses for itself.
 * ICDGEN_NO_TABLES  define it to compute checksums without tables: slower, and smaller by 512 bytes each.
 * ICDGEN_NO_FILES   define it for a program that transfers no files and programs: these are unsupported then.
 * ICDGEN_NO_LOGS    define it for a program that reads no logs, of a node that sends none unasked.
 * NODE_CHOSEN       define it, and NODE_WITH_MESSAGE for each message that a program sends or requests, and the tables
 *                   of NODE/link.c hold no others but for those that the wire layer needs itself.
 */

#include "icdgen.h"

#include "wire/linkage.h"

#include "wire/forms.h"

#include "wire/procedure_forms.h"

#include "wire/stream_form.h"

#include "wire/link.h"

#include "wire/events.h"

#include "wire/crc.h"

#include "wire/uart.h"

#include "wire/stream.h"

#include "wire/i2c.h"

#include "wire/can.h"

#include "wire/can_join.h"

#include "wire/log.h"

#include "wire/time.h"

#include "wire/files.h"

#include "wire/client.h"

#include "wire/client_input.h"

#include "wire/stream_client.h"

#include "wire/sizes.h"

#include "wire/procedure.h"

#include "wire/list.h"

#include "wire/download.h"

#include "wire/upload.h"

#include "wire/erase.h"

#include "wire/program.h"

#ifndef ICDGEN_SHARED
#include "icdgen_wire.c"
#endif

#endif /* ICDGEN_WIRE_H */
