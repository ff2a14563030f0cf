#ifndef ICDGEN_WIRE_STREAM_RESPOND_C
#define ICDGEN_WIRE_STREAM_RESPOND_C

#include "stream_encode.c"

/* ---- the device's half of a framed link: responses to telecommands and to requests ------------------------------- */

#define ICDGEN_ID_BYTES 4u /* of the id in front of the data, from which places count */

/* Return whether a value of the ICD says this verdict; without such values, whether the response itself says it. */
static inline bool icdgen_says(const icd_response_t *response, icd_verdict_t verdict)
{
    bool is_listed = false;
    for (size_t i = 0; i < response->meaning_count; ++i) {
        const icd_verdict_t meaning = response->meanings[i].verdict;
        if (meaning != ICD_VERDICT_AGAIN) { /* a refusal for a certain reason */
            is_listed = true;
            if (meaning == verdict) {
                return true;
            }
        }
    }
    return !is_listed && response->verdict == verdict;
}

/* Return whether a value that the ICD does not list says this verdict. */
static inline bool icdgen_says_otherwise(const icd_response_t *response, icd_verdict_t verdict)
{
    const icd_number_place_t *const status = response->status;
    return status != NULL && response->meaning_count <= (UINT32_C(0xFFFFFFFF) >> (32u - status->bits)) &&
        response->verdict == verdict;
}

/*
 * Return the response that says a verdict; NULL without one. One that only refuses precedes one whose status can also
 * refuse.
 */
static inline const icd_response_t *icdgen_response_for(const icd_exchange_t *exchange, icd_verdict_t verdict)
{
    for (size_t i = 0; i < exchange->response_count; ++i) {
        if (icdgen_says(&exchange->responses[i], verdict)) {
            return &exchange->responses[i];
        }
    }
    for (size_t i = 0; i < exchange->response_count; ++i) {
        if (icdgen_says_otherwise(&exchange->responses[i], verdict)) {
            return &exchange->responses[i];
        }
    }
    return NULL;
}

/* Return whether the refusal of an exchange repeats no part of a telecommand but its id. */
static inline bool icdgen_refuses_any(const icd_exchange_t *exchange)
{
    const icd_response_t *const response = icdgen_response_for(exchange, ICD_VERDICT_NAK);
    for (size_t i = 0; response != NULL && i < response->echo_count; ++i) {
        const size_t source = response->echoes[i].source;
        const icd_number_place_t *const place = &exchange->sources[source];
        if (source < ICDGEN_SIZE(exchange->source_count) - exchange->header_count &&
            place->at + place->size > ICDGEN_ID_BYTES) {
            return false;
        }
    }
    return response != NULL;
}

/* Return the exchange by whose response a telecommand is refused that the node does not have; NULL without one. */
static inline const icd_exchange_t *icdgen_refusing(const icd_stream_form_t *form)
{
    for (size_t i = 0; i < form->row_counts[ICD_TELECOMMAND]; ++i) {
        const icd_exchange_t *const exchange = form->rows[ICD_TELECOMMAND][i].exchange;
        if (exchange != NULL && icdgen_refuses_any(exchange)) {
            return exchange;
        }
    }
    const bool refuses = form->request != NULL && icdgen_refuses_any(form->request->exchange);
    return refuses ? form->request->exchange : NULL;
}

/* Return the exchange of a received telecommand or request; NULL if nothing responds to it. */
static inline const icd_exchange_t *icdgen_exchange_of(
    const icd_stream_form_t *form, const icd_event_t *received, icd_verdict_t verdict)
{
    if (received->is_request) {
        return form->request != NULL ? form->request->exchange : NULL;
    }
    const icd_stream_row_t *const row = icdgen_stream_row(form, ICD_TELECOMMAND, received->id);
    if (row != NULL) {
        return row->exchange;
    }
    return verdict == ICD_VERDICT_NAK ? icdgen_refusing(form) : NULL;
}

/* Extend the data of a response by zeros up to a length. Return whether there is room for it. */
static inline bool icdgen_answer_extend(icd_answer_t *answer, size_t length)
{
    while (answer->length < length && answer->length < answer->capacity) {
        answer->data[answer->length] = 0;
        answer->length++;
    }
    return answer->length >= length;
}

/* Put a number into the data of a response. Return whether there is room for it. */
static inline bool icdgen_answer_put(icd_answer_t *answer, const icd_number_place_t *place, uint32_t number)
{
    const size_t at = ICDGEN_SIZE(place->at) - ICDGEN_ID_BYTES;
    if (!icdgen_answer_extend(answer, at + place->size)) {
        return false;
    }
    uint32_t mask = (UINT32_C(0xFFFFFFFF) >> (32u - place->bits)) << place->shift;
    uint32_t rest = number << place->shift;
    for (size_t i = 0; i < place->size; ++i) {
        uint8_t *const byte = &answer->data[at + (place->little ? i : place->size - 1u - i)];
        *byte = ICDGEN_U8((*byte & ~mask & 0xFFu) | (rest & mask & 0xFFu));
        mask >>= 8;
        rest >>= 8;
    }
    return true;
}

/* Put what the response repeats of the telecommand. Return whether there is room for it. */
static inline bool icdgen_answer_repeat(
    icd_answer_t *answer,
    const icd_stream_form_t *form,
    const icd_exchange_t *exchange,
    const icd_response_t *response,
    const icd_event_t *received)
{
    const size_t header_bytes = received->header != NULL ? form->packets[received->packet].header_bytes : 0u;
    for (size_t i = 0; i < response->echo_count; ++i) {
        const icd_echo_t *const echo = &response->echoes[i];
        const icd_number_place_t *const source = &exchange->sources[echo->source];
        const bool in_header = echo->source >= ICDGEN_SIZE(exchange->source_count) - exchange->header_count;
        const uint32_t number = in_header
            ? icdgen_stream_number(source, 0, received->header, header_bytes)
            : icdgen_stream_number(source, received->id, received->data, received->length);
        if ((!in_header || header_bytes != 0u) && !icdgen_answer_put(answer, echo->place, number)) {
            return false;
        }
    }
    return true;
}

/* Return the status that says a verdict: the first of the ICD; otherwise, the smallest number that the ICD omits. */
static inline uint32_t icdgen_status_for(const icd_response_t *response, icd_verdict_t verdict)
{
    for (size_t i = 0; i < response->meaning_count; ++i) {
        if (response->meanings[i].verdict == verdict) {
            return response->meanings[i].value;
        }
    }
    uint32_t status = 0;
    while (icdgen_meaning(response, status) != NULL) {
        status++;
    }
    return status;
}

/* Return whether the data of a response say its verdict and have its reason. */
static inline bool icdgen_answer_holds(const icd_answer_t *answer, const icd_response_t *response)
{
    const uint32_t reason = icdgen_stream_number(response->reason, 0, answer->data, answer->length);
    icd_verdict_t verdict = icdgen_verdict_of(response, 0, answer->data, answer->length);
    /* A refusal can say that the telecommand was damaged. */
    verdict = verdict == ICD_VERDICT_AGAIN ? ICD_VERDICT_NAK : verdict;
    return reason == answer->reason && verdict == answer->verdict;
}

/* Fill a packet without a message with the values of its sender. */
static inline icd_status_t icdgen_answer_begin(
    icd_answer_t *answer, const icd_packet_form_t *packet, const icd_header_values_t *values)
{
    answer->length = 0;
    if (!icdgen_answer_extend(answer, icdgen_packet_around(packet) + packet->reserved)) {
        return ICD_ERROR_LENGTH;
    }
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *const field = &packet->fields[i];
        if (ICDGEN_IS_OF_SENDER(field)) {
            const uint32_t value =
                icdgen_field_is_chosen(field, values) ? values->of[field->role] : field->values[ICD_TELEMETRY];
            const size_t at = field->in_trailer ? answer->length - packet->trailer_bytes : 0u;
            if (value > icdgen_field_mask(field)) {
                return ICD_ERROR_RANGE;
            }
            icdgen_field_put(field, answer->data + at, value);
        }
    }
    return ICD_OK;
}

/* Encode a packet without a message, as it was filled. */
static inline icd_status_t icdgen_answer_send(
    const icd_answer_t *answer,
    icd_stream_sender_t *sender,
    size_t number,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const icd_packet_form_t *const packet = &sender->link->stream->packets[number];
    icd_header_values_t values = sender->values;
    uint32_t id = packet->ids[ICD_TELEMETRY];
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *const field = &packet->fields[i];
        const size_t at = field->in_trailer ? answer->length - packet->trailer_bytes : 0u;
        const uint32_t value = icdgen_field_get(field, answer->data + at);
        if (ICDGEN_IS_OF_SENDER(field)) {
            values.of[field->role] = value;
        } else if (ICDGEN_HAS_ROLE(field, ICD_FIELD_ID)) {
            id |= value << field->values[0];
        } else {
            /* the encoder writes the other fields */
        }
    }
    return icd_stream_send_packet(sender, number, id, &values, buffer, capacity, written);
}

ICDGEN_API icd_status_t icd_stream_respond(
    icd_stream_sender_t *sender,
    const icd_event_t *received,
    const icd_answer_t *answer,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const icd_stream_form_t *const form = sender->link->stream;
    if (form == NULL || sender->direction != ICD_TELEMETRY || !received->has_id) {
        return ICD_ERROR_UNSUPPORTED;
    }
    icd_answer_t filled = *answer;
    const icd_exchange_t *const exchange = icdgen_exchange_of(form, received, answer->verdict);
    const bool is_requested =
        exchange != NULL && exchange->is_request && received->is_request && answer->verdict == ICD_VERDICT_REPLY;
    const icd_response_t *const response =
        exchange != NULL && !is_requested ? icdgen_response_for(exchange, answer->verdict) : NULL;
    if (response == NULL && !is_requested) {
        return ICD_ERROR_UNSUPPORTED;
    }
    const bool is_packet = response != NULL && response->is_packet;
    const uint32_t telemetry = response != NULL ? response->source : received->id;
    if (is_packet) {
        const icd_status_t status = icdgen_answer_begin(&filled, &form->packets[response->source], &sender->values);
        if (status != ICD_OK) {
            return status;
        }
    } else {
        const icd_stream_row_t *const row = icdgen_stream_row(form, ICD_TELEMETRY, telemetry);
        if (row == NULL) {
            return ICD_ERROR_UNSUPPORTED;
        }
        if (filled.length > filled.capacity || !icdgen_answer_extend(&filled, row->least)) {
            return ICD_ERROR_LENGTH;
        }
    }
    if (response != NULL) {
        const bool has_room = icdgen_answer_repeat(&filled, form, exchange, response, received) &&
            (response->status == NULL ||
             icdgen_answer_put(&filled, response->status, icdgen_status_for(response, answer->verdict))) &&
            (response->reason == NULL || !answer->has_reason ||
             icdgen_answer_put(&filled, response->reason, answer->reason));
        if (!has_room) {
            return ICD_ERROR_LENGTH;
        }
        if (response->reason != NULL && answer->has_reason && !icdgen_answer_holds(&filled, response)) {
            return ICD_ERROR_RANGE;
        }
    }
    if (is_packet) {
        return icdgen_answer_send(&filled, sender, ICDGEN_SIZE(response->source), buffer, capacity, written);
    }
    return icd_stream_send(sender, telemetry, filled.data, filled.length, buffer, capacity, written);
}

#endif /* ICDGEN_WIRE_STREAM_RESPOND_C */
