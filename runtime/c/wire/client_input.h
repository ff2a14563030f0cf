#ifndef ICDGEN_WIRE_CLIENT_INPUT_H
#define ICDGEN_WIRE_CLIENT_INPUT_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "uart.h"
#include "i2c.h"
#include "can.h"
#include "can_join.h"
#include "client.h"

/**
 * Process timeouts: send again or end the request whose time is up. Call at the time of the deadline function at the
 * latest; calling more often is harmless. `now` is the current time in milliseconds.
 */
ICDGEN_API void icd_client_tick(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context);

/**
 * UART: pass received bytes to the client, in pieces of any size. Reports the resulting events to `on_event` before it
 * returns.
 */
ICDGEN_API void icd_client_received(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

/** CAN: pass a received packet to the client. Reports the resulting events to `on_event` before it returns. */
ICDGEN_API void icd_client_packet(
    icd_client_t *client, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context);

/**
 * I2C: pass the result of the oldest unfinished transaction to the client: the `count` bytes that were read, or NULL if
 * the transaction failed. After a successful write without read, pass any pointer except NULL. If the time-out of the
 * transaction has passed or its request has ended, the result is reported as ICD_EVENT_LATE.
 */
ICDGEN_API void icd_client_transferred(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_CLIENT_INPUT_H */
