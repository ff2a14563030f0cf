#ifndef ICDGEN_WIRE_EVENTS_H
#define ICDGEN_WIRE_EVENTS_H

#include "forms.h"
#include "stream_form.h"
#include "link.h"

/* ---- events ------------------------------------------------------------------------------------------------------ */

typedef enum {
    ICD_EVENT_MESSAGE,          /**< Decoder: a complete message. */
    ICD_EVENT_GAP,              /**< `missing` messages were lost before this one; 0: this message is a repetition. */
    ICD_EVENT_CHECKSUM,         /**< Dropped: wrong checksum. */
    ICD_EVENT_LENGTH,           /**< Dropped: wrong length of the message. */
    ICD_EVENT_UNKNOWN_ID,       /**< Dropped: the node has no message with this id. */
    ICD_EVENT_OVERRUN,          /**< Dropped: the message is longer than the buffer. */
    ICD_EVENT_FRAMING,          /**< Dropped: wrong constant or delimiter. */
    ICD_EVENT_UNEXPECTED_START, /**< UART: a message started before the previous one ended, which is dropped. */
    ICD_EVENT_PROTOCOL_ERROR,   /**< UART: invalid byte after the escape byte. */
    ICD_EVENT_EMPTY,            /**< UART: an empty message, without an id. */
    ICD_EVENT_DUPLICATE,        /**< CAN: a packet was received twice. */
    ICD_EVENT_INCOMPLETE,       /**< CAN: a message is discarded because `missing` packets are missing. */
    ICD_EVENT_MALFORMED,        /**< CAN: an invalid packet of this message. */
    ICD_EVENT_NO_SLOT,          /**< CAN: no free slot for another sender; the packet is dropped. */
    ICD_EVENT_UNKNOWN_TYPE,     /**< CAN: the ICD has no such message type. */
    ICD_EVENT_UNCHECKED,        /**< Dropped: telemetry without the required checksum. */
    ICD_EVENT_REQUEST,          /**< Decoder of telecommands: a packet that requests telemetry. */
    ICD_EVENT_PACKET,           /**< Decoder: a packet without a message. `data` are all its bytes. */
    ICD_EVENT_DONE,             /**< Client: the request succeeded. */
    ICD_EVENT_SENT,             /**< Client: a telecommand to which nothing responds was sent. */
    ICD_EVENT_REFUSED,          /**< Client: the device refused the request. */
    ICD_EVENT_BUSY,             /**< Client: the device was busy each time, so the request was not executed. */
    ICD_EVENT_TIMEOUT,  /**< Client: no response, or not in time; it is not known whether the request was executed. */
    ICD_EVENT_PROGRESS, /**< Client: the request is still in progress. */
    ICD_EVENT_REPLY,    /**< Client: the requested telemetry; the acknowledge is still to come. */
    ICD_EVENT_ARRIVED,  /**< Client: unsolicited telemetry. */
    ICD_EVENT_LOG,      /**< Client: an unsolicited log message; `data` starts with its id. */
    ICD_EVENT_LATE,     /**< Client: a response to a request that has ended; on I2C the result of a transaction. */
    ICD_EVENT_STRAY     /**< Client: a response without a request. I2C: a result without a transaction. */
} icd_event_kind_t;

/**
 * An event of a decoder or a client. The event and its data are valid only during the call of the callback.
 *
 * Every request ends with one of DONE, SENT, REFUSED, BUSY and TIMEOUT. These events, PROGRESS and REPLY have the
 * direction and the id of the request. LATE and STRAY have the id and the data of the response; on I2C, LATE has the id
 * of the transaction, and no data if nothing was read.
 */
typedef struct {
    icd_event_kind_t kind;
    bool has_id;         /**< Whether `id` is known. */
    bool has_reply;      /**< Events of a request: whether telemetry `reply` led to the event. */
    bool has_code;       /**< REFUSED, BUSY: whether the response has a reason `code`. */
    bool has_detail;     /**< REFUSED on I2C: whether the response has the index `detail` of a parameter. */
    bool may_be_damaged; /**< REFUSED on UART and I2C: the enumeration of the codes does not have `code`. */
    bool is_packet;      /**< Whether the packet or the response contains no message. `data` are all its bytes. */
    uint8_t packet;      /**< Framed links: index of the packet format. */
    bool is_request;     /**< Decoder of telecommands: whether the packet requests telemetry. */
    icd_direction_t direction;
    uint8_t source;          /**< CAN: address of the sender. */
    uint8_t destination;     /**< MESSAGE on CAN. */
    icd_can_kind_t can_kind; /**< MESSAGE on CAN. */
    uint32_t id;
    const uint8_t *data; /**< Data of the message or the response. */
    size_t length;
    const uint8_t *header;  /**< Decoder: header of the packet, also if the packet is dropped. NULL without one. */
    const icd_link_t *link; /**< Client: link of the node, if the event belongs to a message of it; otherwise NULL. */
    uint32_t attempts;      /**< Outcomes: number of times the request was sent. */
    uint32_t missing;       /**< GAP, INCOMPLETE. */
    uint32_t reply;         /**< Id of the telemetry that led to the event. */
    uint32_t code;          /**< Reason of a refusal. */
    uint32_t detail;        /**< Index of the invalid parameter. */
    icd_header_values_t values; /**< Framed links: header and trailer values of a message. */
} icd_event_t;

/** Callback for events. `context` is the pointer that was passed together with the callback. */
typedef void icd_event_fn(void *context, const icd_event_t *event);

#endif /* ICDGEN_WIRE_EVENTS_H */
