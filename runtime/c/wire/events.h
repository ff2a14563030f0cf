#ifndef ICDGEN_WIRE_EVENTS_H
#define ICDGEN_WIRE_EVENTS_H

#include "forms.h"
#include "link.h"

/* ---- events ------------------------------------------------------------------------------------------------------ */

typedef enum {
    ICD_EVENT_MESSAGE,          /**< A whole message. */
    ICD_EVENT_UNEXPECTED_START, /**< UART: a message began within another one, which is dropped. */
    ICD_EVENT_PROTOCOL_ERROR,   /**< UART: the escape byte before a byte that has no meaning there. */
    ICD_EVENT_OVERRUN,          /**< UART: a message longer than the buffer. */
    ICD_EVENT_EMPTY,            /**< UART: a message without an id. */
    ICD_EVENT_DUPLICATE,        /**< CAN: a packet that was there already. */
    ICD_EVENT_INCOMPLETE,       /**< CAN: a message was given up for want of packets. */
    ICD_EVENT_MALFORMED,    /**< A reply of the wrong length; CAN: a packet that cannot be part of such a message. */
    ICD_EVENT_BUSY,         /**< CAN: more senders at once than there is room for; the packet is dropped. */
    ICD_EVENT_UNKNOWN_TYPE, /**< CAN: a message type that the ICD does not have. */
    ICD_EVENT_DONE,         /**< Client: the request succeeded; of telemetry with the frame. */
    ICD_EVENT_REFUSED,      /**< Client: the node refused it. */
    ICD_EVENT_TIMEOUT,      /**< Client: no reply, or the telecommand was never processed. */
    ICD_EVENT_PACKET,       /**< Client: a packet of a download. */
    ICD_EVENT_LOG,          /**< Client: an unsolicited log, with its id. */
    ICD_EVENT_STRAY,        /**< Client: what nobody waits for, with its id (I2C: what was read). */
    ICD_EVENT_CHECKSUM,     /**< Client: the checksum of a frame is wrong; it is waited on. */
    ICD_EVENT_UNCHECKED     /**< Client: a frame has no checksum, though it must; it is waited on. */
} icd_event_kind_t;

/** Kinds of messages on the UART. */
typedef enum { ICD_UART_REPLY, ICD_UART_ACKNOWLEDGE, ICD_UART_PACKET, ICD_UART_LOG, ICD_UART_OTHER } icd_uart_kind_t;

/** What came about. The data last until the function returns that is told of it. */
typedef struct {
    icd_event_kind_t kind;
    uint8_t id;
    const uint8_t *data;
    size_t length;
    const icd_link_t *link;    /**< Of DONE, REFUSED, TIMEOUT: that of the node, else NULL. */
    icd_direction_t direction; /**< Of DONE, REFUSED, TIMEOUT: that of the request. */
    uint32_t attempts;         /**< Of DONE, REFUSED, TIMEOUT: how often it was sent. */
    icd_reason_t reason;       /**< Of REFUSED. */
    int64_t code;              /**< Of REFUSED: the error code, -1 if the bus tells none. */
    int64_t parameter;         /**< Of REFUSED: the parameter at fault, -1 if the bus tells none. */
    uint32_t number;           /**< Of PACKET. */
    uint32_t missing;          /**< Of INCOMPLETE: packets. */
    uint8_t source;            /**< On CAN. */
    uint8_t destination;       /**< Of MESSAGE on CAN. */
    icd_can_kind_t can_kind;   /**< Of MESSAGE on CAN. */
} icd_event_t;

/** Is told of each event, with the context that was given along. */
typedef void icd_event_fn(void *context, const icd_event_t *event);

#endif /* ICDGEN_WIRE_EVENTS_H */
