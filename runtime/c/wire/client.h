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
    ICD_CLIENT_HOLD,  /* waits while a late response could be taken for its own */
    ICD_CLIENT_WAIT,  /* waits for the response */
    ICD_CLIENT_PAUSE, /* I2C: waits before the next poll or the next attempt */
    ICD_CLIENT_POLL   /* I2C: waits for the acknowledge frame */
} icd_client_state_t;

/**
 * A request. `repeat`: whether the client may send it again if the node may already have received it. Telemetry and
 * settings are always repeated.
 */
typedef struct {
    icd_direction_t direction;
    uint32_t id;
    bool repeat;
    const uint8_t *data;
    size_t length;
} icd_request_t;

/* Responses that may still arrive although their request has ended. */
typedef struct {
    icd_direction_t direction;
    uint8_t id;
    uint32_t responses;
    uint32_t until;
} icd_late_t;

/* I2C: a transaction whose result is not yet reported. */
typedef struct {
    uint8_t id;
    bool reads; /* telemetry of this id */
} icd_transaction_t;

typedef struct icd_client icd_client_t;

/** A client: sends one request at a time and reports its outcome. Members without a description are internal. */
struct icd_client {
    const icd_link_t *link;
    icd_client_settings_t settings; /**< Timeouts and retries. May be changed while no request is in progress. */
    icd_bus_t bus;
    bool ready;                               /* initialized without an error */
    bool (*fits)(const icd_client_t *client); /* CAN: whether the request fits into packets */
    void (*expire)(
        icd_client_t *client,
        uint32_t now,
        icd_event_fn *on_event,
        void *context); /* CAN: discards incomplete messages */
    icd_client_state_t state;
    bool checks_telecommands;
    bool checks_telemetry;
    bool sent_whole; /* I2C: the telecommand is sent; its acknowledge is polled */
    bool repeat;
    icd_direction_t direction;
    const icd_message_t *message; /* message of the request */
    uint8_t *whole;               /* request with id and checksum */
    size_t whole_length;
    uint32_t attempts;
    uint32_t until;   /* time at which the state ends */
    uint32_t give_up; /* time at which polling ends */
    uint32_t latest;  /* time until which a response is not late */
    uint32_t awaited; /* number of responses that may still arrive */
    uint8_t late_count;
    icd_late_t late[ICDGEN_MOST_AWAITED]; /* requests that have ended */
    uint8_t address;
    uint8_t poll_id;
    bool poll;        /* to be sent: the request for the acknowledge frame */
    uint32_t pending; /* to be sent: the request, this many times */
    uint8_t taken_count;
    icd_transaction_t taken[ICDGEN_MOST_AWAITED]; /* I2C: transactions, the oldest first */
    icd_uart_encoder_t encoder;
    icd_can_splitter_t splitter;
    uint8_t chunk[32];
    icd_uart_decoder_t decoder;
    icd_can_joiner_t joiner;
    icd_can_slot_t slot;
};

/** Return the buffer size of a client in bytes. NODE_CLIENT_BYTES is the constant of a node. */
ICDGEN_API size_t icd_client_bytes(const icd_link_t *link);

/**
 * Initialize a client on the UART with the timeouts of the ICD. The buffer must stay valid and the client must not be
 * moved or copied while it is in use. NODE_client_uart(), NODE_client_i2c() and NODE_client_can() initialize a client
 * that accepts only the messages of the node at compile time.
 * Return ICD_ERROR_UNSUPPORTED if the node is not on this bus, ICD_ERROR_LENGTH if `size` is less than
 * icd_client_bytes(). After an error the client rejects all requests.
 */
ICDGEN_API icd_status_t icd_client_uart(icd_client_t *client, const icd_link_t *link, uint8_t *buffer, size_t size);

/** Initialize a client on I2C. See icd_client_uart(). */
ICDGEN_API icd_status_t icd_client_i2c(icd_client_t *client, const icd_link_t *link, uint8_t *buffer, size_t size);

/**
 * Initialize a client on CAN. `address` is the CAN address of the client, to which the node replies. See
 * icd_client_uart().
 */
ICDGEN_API icd_status_t
icd_client_can(icd_client_t *client, const icd_link_t *link, uint8_t address, uint8_t *buffer, size_t size);

/** Enable optional checksums. Checksums that the ICD requires on the bus are always used. */
ICDGEN_API void icd_client_use_checksums(icd_client_t *client);

/**
 * Get the time in milliseconds at which icd_client_tick() must be called at the latest. Return false if no request is
 * in progress; `*deadline` has no meaning then.
 */
ICDGEN_API bool icd_client_deadline(const icd_client_t *client, uint32_t *deadline);

/**
 * Start a request. The data are copied. `now` is in milliseconds. A telecommand without acknowledge is reported at once
 * as ICD_EVENT_SENT; `on_event` may be NULL to ignore this.
 * Return ICD_ERROR_UNKNOWN_ID if the node has no such message, ICD_ERROR_BUSY if another request is in progress or its
 * output has not been taken completely, ICD_ERROR_LENGTH if the data have the wrong length, or ICD_ERROR_UNSUPPORTED if
 * the client is not initialized. After an error the client is unchanged.
 */
ICDGEN_API icd_status_t icd_client_start(
    icd_client_t *client, uint32_t now, const icd_request_t *request, icd_event_fn *on_event, void *context);

/**
 * Cancel the request without an event, and drop its remaining output. Another request may then be started; it waits if
 * a late response to the cancelled one could be taken for its own. The late response is reported as ICD_EVENT_LATE.
 */
ICDGEN_API void icd_client_cancel(icd_client_t *client);

/**
 * Request telemetry by id. `now` is in milliseconds. NODE_request_MESSAGE() is the typed version. Errors: see
 * icd_client_start().
 */
ICDGEN_API icd_status_t icd_client_request(icd_client_t *client, uint32_t now, uint8_t id);

/**
 * Send a telecommand by id. NODE_send_MESSAGE() is the typed version. For parameters, events and errors see
 * icd_client_start() and icd_request_t.
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

/**
 * Return whether the event is the reply to a request for telemetry `id` of `node`, or of a node that includes `node`.
 */
ICDGEN_API bool icd_is_reply(const icd_event_t *event, const char *node, uint8_t id);

/**
 * UART: get the next bytes to send. `*bytes` is valid until the next call. Return false if there is nothing to send.
 */
ICDGEN_API bool icd_client_output(icd_client_t *client, const uint8_t **bytes, size_t *count);

/** CAN: get the next packet to send. Return false if there is nothing to send. */
ICDGEN_API bool icd_client_next_packet(icd_client_t *client, icd_can_packet_t *packet);

/**
 * I2C: get the next transaction: write `*count` bytes from `*bytes`, then read `*read` bytes (0: write only). Return
 * false if there is none. Call icd_client_transferred() exactly once for each transaction, in the same order. There is
 * none while the results of eight transactions are missing.
 */
ICDGEN_API bool icd_client_transfer(icd_client_t *client, const uint8_t **bytes, size_t *count, size_t *read);

#endif /* ICDGEN_WIRE_CLIENT_H */
