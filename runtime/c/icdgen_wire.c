#ifndef ICDGEN_WIRE_C
#define ICDGEN_WIRE_C

/*
 * The functions of icdgen_wire.h: compiled once for a program whose units define ICDGEN_SHARED, else part of that
 * header.
 */

#if !defined(ICDGEN_WIRE_H) && !defined(ICDGEN_SHARED)
#define ICDGEN_SHARED
#endif

#include "icdgen_wire.h"

#include "wire/link.c"

#include "wire/events.c"

#include "wire/crc.c"

#include "wire/uart.c"

#include "wire/envelope.h"

#include "wire/stream_encode.c"

#include "wire/stream_decode.c"

#include "wire/i2c.c"

#include "wire/can.c"

#include "wire/can_join.c"

#include "wire/log.c"

#include "wire/time.c"

#include "wire/files.c"

#include "wire/client.c"

#include "wire/client_input.c"

#include "wire/stream_client.c"

#include "wire/procedure.c"

#include "wire/list.c"

#include "wire/download.c"

#include "wire/upload.c"

#include "wire/erase.c"

#include "wire/program.c"

#endif /* ICDGEN_WIRE_C */
