#ifndef ICDGEN_WIRE_C
#define ICDGEN_WIRE_C

/*
 * Functions of icdgen_wire.h. Compile this file once if the program defines ICDGEN_SHARED. Otherwise, icdgen_wire.h
 * includes it.
 */

#if !defined(ICDGEN_WIRE_H) && !defined(ICDGEN_SHARED)
#define ICDGEN_SHARED
#endif

#include "icdgen_wire.h"

#include "wire/link.c"

#include "wire/events.c"

#include "wire/crc.c"

#include "wire/checksum.c"

#include "wire/uart.c"

#include "wire/packet_fields.h"

#include "wire/stream_encode.c"

#include "wire/stream_respond.c"

#include "wire/stream_decode.c"

#include "wire/i2c.c"

#include "wire/can.c"

#include "wire/can_join.c"

#include "wire/log.c"

#include "wire/time.c"

#include "wire/files.c"

#include "wire/client.c"

#include "wire/stream_line.c"

#include "wire/bus_line.c"

#include "wire/uart_line.c"

#include "wire/can_line.c"

#include "wire/i2c_line.c"

#include "wire/procedure.c"

#endif /* ICDGEN_WIRE_C */
