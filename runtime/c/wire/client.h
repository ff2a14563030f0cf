#ifndef ICDGEN_WIRE_CLIENT_H
#define ICDGEN_WIRE_CLIENT_H

#include "../icdgen.h"
#include "linkage.h"
#include "link.h"
#include "events.h"
#include "uart.h"
#include "stream.h"
#include "i2c.h"
#include "can.h"
#include "can_join.h"

/* ---- client ------------------------------------------------------------------------------------------------------ */

/**
 * A request. `repeat`: whether the client may send it again after a time-out, although the node may have received it.
 * Telemetry requests are always repeated, and so are settings and the telecommands that the ICD marks.
 */
typedef struct {
    icd_direction_t direction;
    uint32_t id;
    bool repeat;
    bool has_reply; /**< Framed links: whether `reply` is the id of the reply. If not, the ICD decides. */
    uint32_t reply;
    const uint8_t *data;
    size_t length;
} icd_request_t;

typedef enum {
    ICD_SLOT_QUEUED, /* is to be sent, or its outcome is to be polled */
    ICD_SLOT_SENT,   /* was sent, and nothing responds to it */
    ICD_SLOT_WAIT,   /* waits for a response, or on I2C for the result of a transaction */
    ICD_SLOT_PAUSE   /* the device was busy; on I2C until the next attempt or poll */
} icd_slot_state_t;

#define ICDGEN_NEEDED_VERDICTS 2u /* ICD_VERDICT_ACK and ICD_VERDICT_REPLY: without these a request is not done */

/* The responses that may arrive for a request that was sent. */
typedef struct {
    const icd_exchange_t *exchange;
    bool has_reply;                        /* whether `reply` is given; otherwise as in the ICD */
    bool is_nameless;                      /* the reply comes in a packet without its id */
    bool is_in_order;                      /* I2C: the reply comes with its request, and never late */
    uint16_t owed[ICDGEN_NEEDED_VERDICTS]; /* numbers of responses that may still arrive, by verdict */
    uint32_t reply;                        /* id of the telemetry that the caller specified, or that is requested */
    uint32_t latest;                       /* time until which a response is not late */
    uint32_t sources[ICD_MOST_SOURCES];    /* numbers that responses must repeat */
} icd_awaited_t;

/** Memory for a request. */
typedef struct {
    icd_slot_state_t state;
    icd_direction_t direction;
    bool repeat;
    bool asks_by_id; /* telemetry is requested by its id, not by a telecommand */
    bool is_polled;  /* I2C: the telecommand is written, and its outcome is polled */
    uint8_t missing; /* needed verdicts that did not arrive, as a mask; 0: never sent, or nothing responds */
    uint16_t attempts;
    uint16_t transaction; /* I2C: number of the transaction whose result is awaited; 0: none */
    icd_awaited_t awaited;
    uint32_t id;      /* with which the request was started */
    uint32_t sent_id; /* of the telecommand that is sent, or of the telemetry that is requested by its id */
    uint8_t *data;    /* on UART, I2C and CAN with id and checksum */
    size_t length;
    uint32_t sent_at;  /* time of the last transmission */
    uint32_t until;    /* time at which the state ends */
    uint32_t poll_end; /* I2C: time at which polling ends */
} icd_slot_t;

/** Line of a framed link. `sender.values` are the header and trailer values. */
typedef struct {
    icd_stream_sender_t sender;
    icd_stream_decoder_t decoder;
} icd_stream_line_t;

/** Line of a UART with escape characters. */
typedef struct {
    icd_uart_encoder_t encoder;
    icd_uart_decoder_t decoder;
} icd_uart_line_t;

/** Line of a CAN bus. */
typedef struct {
    icd_can_splitter_t splitter;
    icd_can_joiner_t joiner;
    icd_can_slot_t slot;
    uint8_t address;
} icd_can_line_t;

/* I2C: a transaction whose result is not yet reported. */
typedef struct {
    uint16_t number;
    uint8_t id;
    bool reads; /* telemetry of this id */
} icd_transaction_t;

/** Line of an I2C bus. */
typedef struct {
    uint16_t last; /* number of the last transaction */
    uint8_t poll_id;
    uint8_t taken_count;
    uint8_t first;                                /* index of the oldest transaction */
    icd_transaction_t taken[ICDGEN_MOST_AWAITED]; /* transactions without a result, in a ring */
} icd_i2c_line_t;

typedef struct icd_line icd_line_t; /* functions of the line */

/**
 * A client on any link: sends requests, reports their outcomes and unsolicited telemetry. Members without a description
 * are internal.
 *
 * Requests are sent in the order in which they were started. A request waits while as many are in progress as the
 * device handles, or while a response to another request could be taken for a response to it.
 */
typedef struct {
    bool in_gap; /* less than the gap has passed since `sent_at` */
    bool checks_telecommands;
    bool checks_telemetry;
    uint8_t late_count;             /* number of elements of `late` */
    icd_client_settings_t settings; /**< Times and retries. May be changed while no request is in progress. */
    const icd_link_t *link;
    const icd_line_t *line; /* NULL unless initialized without an error */
    icd_stream_line_t *stream;
    icd_uart_line_t *uart;
    icd_can_line_t *can;
    icd_i2c_line_t *i2c;
    icd_slot_t *slots; /* the requests, in the order in which they were started */
    icd_slot_t *free;  /* behind the last request: free memory, up to `end` */
    icd_slot_t *end;
    const uint8_t *partial;                  /* data of the request whose output is only partly taken; otherwise NULL */
    uint32_t now;                            /* time of the last call */
    uint32_t sent_at;                        /* time of the last transmission */
    icd_awaited_t late[ICDGEN_MOST_AWAITED]; /* requests that have ended */
} icd_client_t;

/**
 * Return the buffer size in bytes of a client for this number of requests. NODE_CLIENT_BYTES is the size for one
 * request; each further request takes NODE_REQUEST_BYTES.
 */
ICDGEN_API size_t icd_client_bytes(const icd_link_t *link, size_t requests);

/**
 * Initialize a client on a UART with the settings of the ICD. `line` is its state. `slot_count` is the number of
 * requests that can be in progress or waiting at the same time. `line`, `slots` and `buffer` must stay valid while the
 * client is in use. NODE_client_uart(), NODE_client_i2c() and NODE_client_can() initialize a client that accepts only
 * the messages of the node at compile time.
 * Return ICD_ERROR_UNSUPPORTED if the node is not on this bus, ICD_ERROR_LENGTH if `size` is less than
 * icd_client_bytes(). After an error the client rejects all requests.
 */
ICDGEN_API icd_status_t icd_client_uart(
    icd_client_t *client,
    const icd_link_t *link,
    icd_uart_line_t *line,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size);

/** Initialize a client on I2C. See icd_client_uart(). */
ICDGEN_API icd_status_t icd_client_i2c(
    icd_client_t *client,
    const icd_link_t *link,
    icd_i2c_line_t *line,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size);

/**
 * Initialize a client on CAN. `address` is the CAN address of the client, to which the node replies. See
 * icd_client_uart().
 */
ICDGEN_API icd_status_t icd_client_can(
    icd_client_t *client,
    const icd_link_t *link,
    icd_can_line_t *line,
    uint8_t address,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size);

/**
 * Initialize a client on a framed link with the settings and values of the ICD. `sequences` has twice NODE_SEQUENCES
 * elements; with fewer elements, some messages are not counted. For the other parameters and errors see
 * icd_client_uart().
 */
ICDGEN_API icd_status_t icd_client_stream(
    icd_client_t *client,
    const icd_link_t *link,
    icd_stream_line_t *line,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size,
    uint32_t *sequences,
    size_t sequence_count);

/** UART, I2C and CAN: enable optional checksums. Checksums that the ICD requires on the bus are always used. */
ICDGEN_API void icd_client_use_checksums(icd_client_t *client);

/**
 * Get the time in milliseconds at which icd_client_tick() must be called at the latest. Return false if no request is
 * in progress; `*deadline` has no meaning then.
 */
ICDGEN_API bool icd_client_deadline(const icd_client_t *client, uint32_t *deadline);

/**
 * Start a request, which the next output contains. The data are copied. `now` is in milliseconds.
 * Return ICD_ERROR_UNKNOWN_ID if the node has no such message, ICD_ERROR_BUSY if no slot is free or the output of the
 * request that was in the slot is only partly taken, ICD_ERROR_LENGTH if the data have the wrong length,
 * ICD_ERROR_RANGE if a header or trailer value does not fit into its field, or ICD_ERROR_UNSUPPORTED if nothing
 * requests this telemetry without parameters, a reply is given on UART, I2C or CAN, or the client is not initialized.
 * After an error the client is unchanged.
 */
ICDGEN_API icd_status_t icd_client_start(icd_client_t *client, uint32_t now, const icd_request_t *request);

/**
 * Request telemetry; on a framed link by the telecommand that it replies to, or by a packet with its id.
 * NODE_request_MESSAGE() is the typed version. Errors: see icd_client_start().
 */
ICDGEN_API icd_status_t icd_client_request(icd_client_t *client, uint32_t now, uint32_t id);

/**
 * Send a telecommand. The ICD decides which responses it has. NODE_send_MESSAGE() is the typed version. Errors: see
 * icd_client_start().
 */
ICDGEN_API icd_status_t
icd_client_send(icd_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, bool repeat);

/**
 * Framed links: send a telecommand and wait for telemetry `reply`, whichever reply the ICD specifies. Errors: see
 * icd_client_start().
 */
ICDGEN_API icd_status_t
icd_client_ask(icd_client_t *client, uint32_t now, uint32_t id, const uint8_t *data, size_t length, uint32_t reply);

/**
 * UART and framed links: write the next bytes to send into the buffer. Its time-outs count from the `now` of the
 * previous call of another function. Return false if there are none; on framed links also if the buffer is too small,
 * where NODE_LINE_BYTES are always enough. Call it until it returns false, after each call of another function.
 *
 * UART and CAN: a request whose output is only partly taken has no time-out and keeps its slot. If you cannot send the
 * rest, such as after a failed write, drop it with icd_client_cancel().
 */
ICDGEN_API bool icd_client_output(icd_client_t *client, uint8_t *buffer, size_t capacity, size_t *written);

/** CAN: get the next packet to send. Return false if there is none. See icd_client_output(). */
ICDGEN_API bool icd_client_next_packet(icd_client_t *client, icd_can_packet_t *packet);

/**
 * I2C: get the next transaction: write `*count` bytes from `*bytes`, then read `*read` bytes (0: write only). The bytes
 * are valid until the next call of another function. Return false if there is none. Call icd_client_transferred()
 * exactly once for each transaction, in the same order. There is none while the results of eight transactions are
 * missing.
 */
ICDGEN_API bool icd_client_transfer(icd_client_t *client, const uint8_t **bytes, size_t *count, size_t *read);

/**
 * UART and framed links: pass received bytes to the client: a piece of the stream of any size, or one packet. `now` is
 * in milliseconds. Reports the resulting events to `on_event` before it returns. The callback may start and cancel
 * requests.
 */
ICDGEN_API void icd_client_received(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

/** CAN: pass a received packet to the client. See icd_client_received(). */
ICDGEN_API void icd_client_packet(
    icd_client_t *client, uint32_t now, const icd_can_packet_t *packet, icd_event_fn *on_event, void *context);

/**
 * I2C: pass the result of the oldest unfinished transaction to the client: the `count` bytes that were read, or NULL if
 * the transaction failed. After a successful write without read, pass any pointer except NULL. If the time-out of the
 * transaction has passed or its request has ended, the result is reported as ICD_EVENT_LATE. See icd_client_received().
 */
ICDGEN_API void icd_client_transferred(
    icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count, icd_event_fn *on_event, void *context);

/**
 * Process time-outs: send again or end the requests whose time is up. Call at the time of the deadline function at the
 * latest; calling more often is harmless. `now` is the current time in milliseconds.
 */
ICDGEN_API void icd_client_tick(icd_client_t *client, uint32_t now, icd_event_fn *on_event, void *context);

/** Cancel all requests without events, and drop their remaining output. A response is reported as ICD_EVENT_LATE. */
ICDGEN_API void icd_client_cancel(icd_client_t *client);

/** Cancel only the requests of this message. */
ICDGEN_API void icd_client_cancel_request(icd_client_t *client, icd_direction_t direction, uint32_t id);

/**
 * Return whether the event contains telemetry `id` of `node`, or of a node that includes `node`, unsolicited or as a
 * response.
 */
ICDGEN_API bool icd_is_telemetry(const icd_event_t *event, const char *node, uint32_t id);

#endif /* ICDGEN_WIRE_CLIENT_H */
