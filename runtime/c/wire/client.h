#ifndef ICDGEN_WIRE_CLIENT_H
#define ICDGEN_WIRE_CLIENT_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "uart.h"
#include "i2c.h"
#include "can.h"
#include "can_join.h"

/* ---- client ------------------------------------------------------------------------------------------------------ */

typedef enum {
    ICD_CLIENT_IDLE,
    ICD_CLIENT_HOLD,  /* a late reply to the request before may still come */
    ICD_CLIENT_WAIT,  /* for the reply */
    ICD_CLIENT_PAUSE, /* I2C: before polling or sending again */
    ICD_CLIENT_POLL   /* I2C: for the acknowledge frame */
} icd_client_state_t;

/**
 * A request. `repeat`: whether it may be sent again although it may have arrived; of telemetry and settings it always
 * may.
 */
typedef struct {
    icd_direction_t direction;
    uint8_t id;
    bool repeat;
    const uint8_t *data;
    size_t length;
} icd_request_t;

typedef struct icd_client icd_client_t;

/** One request at a time, from sending to its outcome. */
struct icd_client {
    const icd_link_t *link;
    icd_client_settings_t settings; /**< May be changed while no request is going on. */
    icd_bus_t bus;
    bool ready;                               /* it was begun without an error */
    bool (*fits)(const icd_client_t *client); /* CAN: whether the request fits its packets */
    void (*expire)(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context); /* CAN: old packets */
    icd_client_state_t state;
    bool checks_telecommands;
    bool checks_telemetry;
    bool sent_whole; /* I2C: the telecommand is sent, its acknowledge is polled */
    bool repeat;
    icd_direction_t direction;
    const icd_message_t *message; /* that is requested */
    uint8_t *whole;               /* the request with its id and checksum */
    size_t whole_length;
    uint32_t attempts;
    uint32_t until;   /* when the state ends by itself */
    uint32_t give_up; /* when polling ends */
    bool echo;        /* a second reply to echo_id may come until echo_end */
    uint8_t echo_id;
    uint32_t echo_end;
    uint8_t address;
    uint8_t poll_id;
    bool poll;        /* to be sent: the request for the acknowledge frame ... */
    uint32_t pending; /* ... and the request, so many times */
    uint32_t owed;    /* I2C: transactions taken of which icd_client_transferred() was not told */
    icd_uart_encoder_t encoder;
    icd_can_splitter_t splitter;
    uint8_t chunk[32];
    icd_uart_decoder_t decoder;
    icd_can_joiner_t joiner;
    icd_can_slot_t slot;
};

/** Bytes of buffer that a client needs: NODE_CLIENT_BYTES is the constant for a node. */
ICDGEN_API size_t icd_client_bytes(const icd_link_t *link);

/**
 * Begins a client on the UART, with the times of the ICD. ICD_ERROR_UNSUPPORTED if the node is not on that bus,
 * ICD_ERROR_LENGTH if the buffer is smaller than icd_client_bytes(); it refuses every request then. The client must
 * stay where it is. NODE_client_uart() begins one that takes the messages of the node only, and so the next two.
 */
ICDGEN_API icd_status_t icd_client_uart(icd_client_t *client, const icd_link_t *link, uint8_t *buffer, size_t size);

/** On I2C, as icd_client_uart(). */
ICDGEN_API icd_status_t icd_client_i2c(icd_client_t *client, const icd_link_t *link, uint8_t *buffer, size_t size);

/** On CAN, as icd_client_uart(); `address` is ours, to which the node replies. */
ICDGEN_API icd_status_t
icd_client_can(icd_client_t *client, const icd_link_t *link, uint8_t address, uint8_t *buffer, size_t size);

/** Uses checksums where the ICD leaves the choice for the bus. Where it demands them, they are used in any case. */
ICDGEN_API void icd_client_use_checksums(icd_client_t *client);

/** When icd_client_tick() wants to be called at the latest; false: not at all. */
ICDGEN_API bool icd_client_deadline(const icd_client_t *client, uint32_t *deadline);

/**
 * Begins a request; its data are copied. ICD_ERROR_UNKNOWN_ID, ICD_ERROR_BUSY while another one is going on or has not
 * been taken by the output functions, ICD_ERROR_LENGTH, ICD_ERROR_UNSUPPORTED if the client could not be begun; nothing
 * has happened then. `on_event` NULL: that a telecommand needs no acknowledge, and is done at once, is told to nobody.
 */
ICDGEN_API icd_status_t icd_client_start(
    icd_client_t *client, uint32_t now, const icd_request_t *request, icd_event_fn *on_event, void *context);

/**
 * Gives up the request, without an event, and what of it has not been taken: the next one may begin. A late reply to
 * this one is ICD_EVENT_STRAY.
 */
ICDGEN_API void icd_client_cancel(icd_client_t *client);

/** Requests telemetry. NODE_request_MESSAGE() does so by name. */
ICDGEN_API icd_status_t icd_client_request(icd_client_t *client, uint32_t now, uint8_t id);

/**
 * Sends a telecommand, whose data are copied. One that is not acknowledged is ICD_EVENT_DONE at once.
 * NODE_send_MESSAGE() does so by name.
 */
ICDGEN_API icd_status_t icd_client_send(
    icd_client_t *client,
    uint32_t now,
    uint8_t id,
    const uint8_t *data,
    size_t length,
    bool repeat,
    icd_event_fn *on_event,
    void *context);

/** Whether the event is the reply to a request for that telemetry of that node, or of one that includes it. */
ICDGEN_API bool icd_is_reply(const icd_event_t *event, const char *node, uint8_t id);

/** The next bytes for the UART; false when there are none. They last until the next call. */
ICDGEN_API bool icd_client_output(icd_client_t *client, const uint8_t **bytes, size_t *count);

/** The next packet for CAN; false when there is none. */
ICDGEN_API bool icd_client_next_packet(icd_client_t *client, icd_can_packet_t *packet);

/**
 * The next transaction on I2C: bytes to write, and how many to read then; false when there is none.
 * icd_client_transferred() is told of each that was taken, once and in this order.
 */
ICDGEN_API bool icd_client_transfer(icd_client_t *client, const uint8_t **bytes, size_t *count, size_t *read);

#endif /* ICDGEN_WIRE_CLIENT_H */
