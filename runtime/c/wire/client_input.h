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

/** Lets time pass. */
ICDGEN_API void icd_client_tick(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context);

/** UART: takes the next bytes of the stream. */
ICDGEN_API void icd_client_received(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

/** CAN: takes a packet. */
ICDGEN_API void icd_client_packet(
    icd_client_t *client, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context);

/**
 * I2C: takes what was read in the oldest transaction that was taken and not told of; `bytes` NULL: it failed. Of a
 * write without reading, anything but NULL. What a request owed that is over is ICD_EVENT_STRAY.
 */
ICDGEN_API void icd_client_transferred(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

#endif /* ICDGEN_WIRE_CLIENT_INPUT_H */
