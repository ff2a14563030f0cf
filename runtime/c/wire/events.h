#ifndef ICDGEN_WIRE_EVENTS_H
#define ICDGEN_WIRE_EVENTS_H

#include "forms.h"
#include "link.h"

/* ---- events ------------------------------------------------------------------------------------------------------ */

typedef enum {
    ICD_EVENT_MESSAGE,          /**< A complete message. */
    ICD_EVENT_UNEXPECTED_START, /**< UART: a message started before the previous one ended, which is dropped. */
    ICD_EVENT_PROTOCOL_ERROR,   /**< UART: invalid byte after the escape byte. */
    ICD_EVENT_OVERRUN,          /**< UART: a message is longer than the buffer. */
    ICD_EVENT_EMPTY,            /**< UART: an empty message, without an id. */
    ICD_EVENT_DUPLICATE,        /**< CAN: a packet was received twice. */
    ICD_EVENT_INCOMPLETE,       /**< CAN: a message is discarded because packets are missing. */
    ICD_EVENT_MALFORMED,        /**< CAN: an invalid packet of this message. */
    ICD_EVENT_BUSY,             /**< CAN: no free slot for another sender; the packet is dropped. */
    ICD_EVENT_UNKNOWN_TYPE,     /**< CAN: the ICD has no such message type. */
    ICD_EVENT_DONE,             /**< Client: the request succeeded; for telemetry, `data` is the frame. */
    ICD_EVENT_SENT,             /**< Client: a telecommand to which nothing responds was sent. */
    ICD_EVENT_REFUSED,          /**< Client: the node rejected the request (negative acknowledge). */
    ICD_EVENT_TIMEOUT,          /**< Client: no reply, or the node did not process the telecommand in time. */
    ICD_EVENT_ARRIVED,          /**< Client: unsolicited telemetry. */
    ICD_EVENT_LOG,              /**< Client: an unsolicited log message; `data` starts with its id. */
    ICD_EVENT_LATE,     /**< Client: a response to a request that has ended; on I2C the result of a transaction. */
    ICD_EVENT_STRAY,    /**< Client: a response without a request. I2C: a result without a transaction. */
    ICD_EVENT_LENGTH,   /**< Client: telemetry of the wrong length; the request continues. */
    ICD_EVENT_CHECKSUM, /**< Client: a frame with a wrong checksum; the request continues. */
    ICD_EVENT_UNCHECKED /**< Client: a frame without the required checksum; the request continues. */
} icd_event_kind_t;

/** Kinds of messages from the node on the UART. */
typedef enum { ICD_UART_REPLY, ICD_UART_ACKNOWLEDGE, ICD_UART_ARRIVED, ICD_UART_LOG, ICD_UART_OTHER } icd_uart_kind_t;

/**
 * An event. The event and its data are valid only during the call of the callback.
 *
 * Every request ends with one of DONE, SENT, REFUSED and TIMEOUT, which have the id of the request. LATE and STRAY have
 * the id and the data of the response. I2C: LATE has the id of the transaction, and no data if nothing was read; STRAY
 * has no id.
 */
typedef struct {
    icd_event_kind_t kind;
    uint8_t id;
    const uint8_t *data;
    size_t length;
    const icd_link_t *link;    /**< Outcomes: link of the node; otherwise NULL. */
    icd_direction_t direction; /**< Outcomes: direction of the request. */
    uint32_t attempts;         /**< Outcomes: number of times the request was sent. */
    icd_reason_t reason;       /**< REFUSED: meaning of the error code. */
    int64_t code;              /**< REFUSED: error code, -1 if the bus does not report it. */
    int64_t parameter;         /**< REFUSED: index of the invalid parameter, -1 if the bus does not report it. */
    uint32_t missing;          /**< INCOMPLETE: number of missing packets. */
    uint8_t source;            /**< CAN: address of the sender. */
    uint8_t destination;       /**< MESSAGE on CAN. */
    icd_can_kind_t can_kind;   /**< MESSAGE on CAN. */
} icd_event_t;

/** Callback for events. `context` is the pointer that was passed together with the callback. */
typedef void icd_event_fn(void *context, const icd_event_t *event);

#endif /* ICDGEN_WIRE_EVENTS_H */
