#ifndef ICDGEN_WIRE_PROCEDURE_C
#define ICDGEN_WIRE_PROCEDURE_C

#include "procedure.h"
#include "packet_fields.h"
#include "link.c"
#include "events.c"
#include "crc.c"
#include "client.c"

static inline void icdgen_end(icd_procedure_t *procedure, icd_result_t result)
{
    procedure->result = result;
    procedure->has_request = false;
    procedure->waits = false;
}

static inline void icdgen_go_to(icd_procedure_t *procedure, uint16_t index)
{
    procedure->at = index;
    procedure->is_entered = false;
}

static inline void icdgen_go_on(icd_procedure_t *procedure)
{
    icdgen_go_to(procedure, ICDGEN_U16(procedure->at + 1u));
}

/* Return whether the step begins, and not only continues. */
static inline bool icdgen_enter(icd_procedure_t *procedure)
{
    const bool begins = !procedure->is_entered;
    procedure->is_entered = true;
    return begins;
}

static inline const icd_step_form_t *icdgen_step(const icd_procedure_t *procedure)
{
    return &procedure->form->steps[procedure->at];
}

static inline uint32_t icdgen_value(const icd_procedure_t *procedure, const icd_value_t *value)
{
    return value->in_register ? procedure->registers[value->number] : value->number;
}

static inline bool icdgen_holds(const icd_procedure_t *procedure, const icd_test_t *test)
{
    return procedure->registers[test->of] == icdgen_value(procedure, &test->value);
}

/* ---- requests ---------------------------------------------------------------------------------------------------- */

static inline void icdgen_ask(icd_procedure_t *procedure, icd_direction_t direction, uint32_t id, bool repeat)
{
    (void)memset(&procedure->request, 0, sizeof procedure->request);
    procedure->request.direction = direction;
    procedure->request.id = id;
    procedure->request.repeat = repeat;
    procedure->has_request = true;
    procedure->is_requested = false;
    procedure->has_reply = false;
    procedure->damaged = 0;
}

/* Return the data of a telecommand, which are sent with the request. */
static inline uint8_t *icdgen_ask_with(icd_procedure_t *procedure, uint32_t id, uint16_t length, bool repeat)
{
    icdgen_ask(procedure, ICD_TELECOMMAND, id, repeat);
    procedure->request.data = procedure->data;
    procedure->request.length = length;
    (void)memset(procedure->data, 0, length);
    return procedure->data;
}

/* Write a number into the data of a telecommand. */
static inline void icdgen_put_at(const icd_number_place_t *place, uint8_t *data, uint32_t number)
{
    uint32_t mask = (UINT32_C(0xFFFFFFFF) >> (32u - place->bits)) << place->shift;
    uint32_t bits = number << place->shift;
    for (size_t i = 0; i < place->size; ++i) {
        uint8_t *const byte =
            &data[place->at - sizeof(uint32_t) + (place->little ? i : ICDGEN_SIZE(place->size) - 1u - i)];
        *byte = ICDGEN_U8((*byte & ~mask & 0xFFu) | (bits & mask & 0xFFu));
        mask >>= 8;
        bits >>= 8;
    }
}

/* Write the selected packet, up to the end of the block and then the fill. */
static inline void icdgen_put_packet(const icd_procedure_t *procedure, uint8_t *packet)
{
    const icd_blocks_form_t *const blocks = procedure->form->blocks;
    const uint32_t *const registers = procedure->registers;
    const uint32_t start = registers[ICD_PACKET_OFFSET];
    const uint32_t left = registers[ICD_BLOCK_OFFSET] + registers[ICD_BLOCK_LENGTH] - start;
    (void)memset(packet, blocks->fill, blocks->packet_bytes);
    (void)memcpy(
        packet, procedure->memory.bytes + start,
        ICDGEN_SIZE(left < blocks->packet_bytes ? left : blocks->packet_bytes));
}

static inline void icdgen_send_step(icd_procedure_t *procedure, const icd_send_form_t *send)
{
    uint8_t *const data = icdgen_ask_with(procedure, send->id, send->length, send->repeats);
    if (send->data != NULL) {
        (void)memcpy(data, send->data, send->length);
    }
    for (size_t i = 0; i < send->put_count; ++i) {
        icdgen_put_at(&send->puts[i].place, data, icdgen_value(procedure, &send->puts[i].value));
    }
    if (send->packet_at >= 0) {
        icdgen_put_packet(procedure, data + send->packet_at);
    }
}

static inline void icdgen_poll_step(icd_procedure_t *procedure, const icd_poll_form_t *poll)
{
    if (icdgen_enter(procedure)) {
        procedure->end = procedure->now + poll->timeout;
    }
    icdgen_ask(procedure, ICD_TELEMETRY, poll->id, true);
}

/* Keep fields of the telemetry, and decide whether to request it again. */
static inline void icdgen_polled(icd_procedure_t *procedure, const icd_poll_form_t *poll)
{
    bool is_ready = true, has_failed = false;
    for (size_t i = 0; i < poll->take_count; ++i) {
        const icd_take_t *const take = &poll->takes[i];
        procedure->registers[take->into] =
            icdgen_stream_number(&take->place, 0, procedure->frame, procedure->frame_length);
    }
    for (size_t i = 0; i < poll->until_count; ++i) {
        is_ready = is_ready && icdgen_holds(procedure, &poll->tests[i]);
    }
    for (size_t i = 0; i < poll->fails_count; ++i) {
        has_failed = has_failed || icdgen_holds(procedure, &poll->tests[poll->until_count + i]);
    }
    if (has_failed) {
        icdgen_end(procedure, ICD_FAILED);
    } else if (is_ready) {
        icdgen_go_on(procedure);
    } else if (icdgen_reached(procedure->now, procedure->end)) {
        icdgen_end(procedure, ICD_TIMED_OUT);
    } else {
        procedure->waits = true;
        procedure->until = procedure->now + poll->interval;
    }
}

/* ---- blocks and packets ------------------------------------------------------------------------------------------ */

static inline uint32_t icdgen_parts(uint32_t length, uint32_t part)
{
    return (length / part) + (length % part != 0u ? 1u : 0u);
}

static inline bool icdgen_is_there(const icd_procedure_t *procedure, uint32_t position)
{
    return ((ICDGEN_U32(procedure->memory.bitmap[position / 8u]) >> (position % 8u)) & 1u) != 0u;
}

/* Note whether a packet is there. */
static inline void icdgen_mark(icd_procedure_t *procedure, uint32_t position, bool is_there)
{
    uint8_t *const byte = &procedure->memory.bitmap[position / 8u];
    if (icdgen_is_there(procedure, position) != is_there) {
        *byte = ICDGEN_U8(*byte ^ (1u << (position % 8u)));
        procedure->missing = is_there ? procedure->missing - 1u : procedure->missing + 1u;
    }
    procedure->registers[ICD_BLOCK_IS_EMPTY] = ICDGEN_U32(procedure->missing == procedure->count ? 1u : 0u);
}

static inline uint32_t icdgen_total(const icd_procedure_t *procedure)
{
    const icd_blocks_form_t *const blocks = procedure->form->blocks;
    if (blocks->sends) {
        return ICDGEN_U32(procedure->memory.byte_count);
    }
    return blocks->total != 0u ? procedure->registers[blocks->total] : ICD_UNKNOWN;
}

/* Set the length of the block. No packet is there. */
static inline void icdgen_set_length(icd_procedure_t *procedure, uint32_t length)
{
    const icd_blocks_form_t *const blocks = procedure->form->blocks;
    procedure->registers[ICD_BLOCK_LENGTH] = length;
    procedure->registers[ICD_BLOCK_IS_EMPTY] = 1;
    procedure->count = icdgen_parts(length, blocks->packet_bytes);
    procedure->missing = procedure->count;
    (void)memset(procedure->memory.bitmap, 0, ICDGEN_SIZE(icdgen_parts(procedure->count, 8)));
    if (!blocks->sends) {
        (void)memset(procedure->memory.buffer, blocks->fill, ICDGEN_SIZE(procedure->count * blocks->packet_bytes));
    }
}

/* Transfer the block, for the first time or again. */
static inline void icdgen_begin_block(icd_procedure_t *procedure)
{
    procedure->has_round = false;
    icdgen_set_length(procedure, procedure->requested);
}

/* Deliver the block. Return whether it was shorter than requested. */
static inline bool icdgen_end_block(icd_procedure_t *procedure)
{
    const icd_procedure_memory_t *const memory = &procedure->memory;
    const uint32_t offset = procedure->registers[ICD_BLOCK_OFFSET];
    const uint32_t length = procedure->registers[ICD_BLOCK_LENGTH];
    if (!procedure->form->blocks->sends && length != 0u && memory->on_block != NULL) {
        memory->on_block(memory->context, offset, memory->buffer, ICDGEN_SIZE(length));
    }
    procedure->registers[ICD_BLOCK_OFFSET] = offset + length;
    procedure->registers[ICD_BLOCK_LENGTH] = 0;
    procedure->count = 0;
    procedure->missing = 0;
    procedure->has_block = false;
    procedure->has_round = false;
    return length < procedure->requested;
}

static inline void icdgen_next_block(icd_procedure_t *procedure, uint16_t to)
{
    const uint32_t total = icdgen_total(procedure);
    const bool is_shorter = procedure->has_block && icdgen_end_block(procedure);
    const uint32_t offset = procedure->registers[ICD_BLOCK_OFFSET];
    const uint32_t left = total - offset;
    if ((total == ICD_UNKNOWN && is_shorter) || (total != ICD_UNKNOWN && offset >= total)) {
        icdgen_go_to(procedure, to);
        return;
    }
    procedure->has_block = true;
    procedure->requested = total != ICD_UNKNOWN && left < procedure->memory.block ? left : procedure->memory.block;
    procedure->rounds = 0;
    icdgen_begin_block(procedure);
    icdgen_go_on(procedure);
}

static inline void icdgen_set_length_step(icd_procedure_t *procedure, uint32_t length)
{
    const uint32_t offset = procedure->registers[ICD_BLOCK_OFFSET], most = procedure->form->blocks->most;
    if (length > procedure->requested || (icdgen_total(procedure) != ICD_UNKNOWN && length != procedure->requested)) {
        icdgen_end(procedure, ICD_LENGTH);
    } else if (offset > most || length > most - offset) {
        icdgen_end(procedure, ICD_LIMIT);
    } else {
        icdgen_set_length(procedure, length);
        icdgen_go_on(procedure);
    }
}

/* Transfer the block again if the ICD says so, as often as it allows. */
static inline void icdgen_again(icd_procedure_t *procedure, bool again, icd_result_t result)
{
    const icd_blocks_form_t *const blocks = procedure->form->blocks;
    if (!again) {
        icdgen_end(procedure, result);
    } else if (procedure->rounds == blocks->rounds) {
        icdgen_end(procedure, ICD_CHECKSUM);
    } else {
        procedure->rounds += procedure->has_round ? 0u : 1u;
        icdgen_begin_block(procedure);
        icdgen_go_to(procedure, blocks->begin);
    }
}

static inline void icdgen_next_round(icd_procedure_t *procedure, uint16_t to)
{
    if (procedure->missing == 0u) {
        icdgen_go_to(procedure, to);
    } else if (procedure->rounds == procedure->form->blocks->rounds) {
        icdgen_end(procedure, ICD_ROUNDS);
    } else {
        procedure->rounds++;
        procedure->has_round = true;
        procedure->cursor = 0;
        icdgen_go_on(procedure);
    }
}

static inline void icdgen_next_packet(icd_procedure_t *procedure, uint16_t to)
{
    const icd_blocks_form_t *const blocks = procedure->form->blocks;
    uint32_t *const registers = procedure->registers;
    uint32_t position = procedure->cursor;
    while (position < procedure->count && icdgen_is_there(procedure, position)) {
        position++;
    }
    if (position >= procedure->count) {
        icdgen_go_to(procedure, to);
        return;
    }
    procedure->cursor = position + 1u;
    registers[ICD_PACKET_NUMBER] = blocks->first_packet + position;
    registers[ICD_PACKET_OFFSET] = registers[ICD_BLOCK_OFFSET] + (position * blocks->packet_bytes);
    icdgen_go_on(procedure);
}

static inline bool icdgen_is_receiving(const icd_procedure_t *procedure)
{
    return procedure->at < procedure->form->step_count && icdgen_step(procedure)->kind == ICDGEN_U8(ICD_STEP_RECEIVE);
}

/* Keep a packet if it is new. Before the first round, it may belong to the previous block. */
static inline void icdgen_take_packet(
    icd_procedure_t *procedure, const icd_receive_form_t *receive, const uint8_t *data, size_t length)
{
    const icd_blocks_form_t *const blocks = procedure->form->blocks;
    const uint32_t position = icdgen_stream_number(&receive->number, 0, data, length) - blocks->first_packet;
    if (!procedure->has_round || length < ICDGEN_SIZE(receive->data_at) + blocks->packet_bytes ||
        position >= procedure->count || icdgen_is_there(procedure, position)) {
        return;
    }
    (void)memcpy(
        procedure->memory.buffer + ICDGEN_SIZE(position * blocks->packet_bytes), data + receive->data_at,
        blocks->packet_bytes);
    icdgen_mark(procedure, position, true);
    procedure->last_packet = procedure->now;
    if (procedure->waits && icdgen_is_receiving(procedure)) {
        procedure->until = procedure->now + (procedure->missing != 0u ? receive->silence : 0u);
    }
}

static inline void icdgen_receive_step(icd_procedure_t *procedure, const icd_receive_form_t *receive)
{
    if (icdgen_enter(procedure)) {
        procedure->last_packet = procedure->now;
        procedure->left = procedure->missing;
    }
    const uint32_t end = procedure->last_packet + receive->silence;
    if (procedure->link->stream == NULL && icdgen_on_bus(receive->requested_on, procedure->bus)) {
        if (procedure->left != 0u) {
            icdgen_ask(procedure, ICD_TELEMETRY, receive->id, true);
        } else {
            icdgen_go_on(procedure);
        }
    } else if (procedure->missing == 0u || icdgen_reached(procedure->now, end)) {
        icdgen_go_on(procedure);
    } else {
        procedure->waits = true;
        procedure->until = end;
    }
}

/* Go on after the last of several requests. */
static inline void icdgen_count_request(icd_procedure_t *procedure)
{
    procedure->left--;
    if (procedure->left == 0u) {
        icdgen_go_on(procedure);
    }
}

/* ---- map of the received packets --------------------------------------------------------------------------------- */

static inline uint32_t icdgen_map_bits(const icd_procedure_t *procedure)
{
    return 8u * ICDGEN_U32(procedure->form->blocks->map->bytes);
}

/* Return the index of the message of the map. */
static inline uint32_t icdgen_map_index(const icd_procedure_t *procedure)
{
    return icdgen_parts(procedure->count, icdgen_map_bits(procedure)) - procedure->left;
}

static inline uint8_t icdgen_map_bit(const icd_map_form_t *map, uint32_t bit)
{
    return ICDGEN_U8(1u << (map->msb0 ? 7u - (bit % 8u) : bit % 8u));
}

/* Send or request the next message of the map. */
static inline void icdgen_map_step(icd_procedure_t *procedure, bool sends)
{
    const icd_map_form_t *const map = procedure->form->blocks->map;
    const uint32_t bits = icdgen_map_bits(procedure);
    if (icdgen_enter(procedure)) {
        procedure->left = icdgen_parts(procedure->count, bits);
    }
    const uint32_t index = icdgen_map_index(procedure);
    if (procedure->left == 0u) {
        icdgen_go_on(procedure);
    } else if (sends) {
        uint8_t *const data = icdgen_ask_with(procedure, map->messages[index].telecommand, map->length, true);
        for (uint32_t bit = 0; bit < bits; ++bit) {
            const uint32_t position = (index * bits) + bit;
            uint8_t *const byte = &data[map->at + (bit / 8u)];
            const bool one =
                position < procedure->count ? icdgen_is_there(procedure, position) == map->received : map->beyond_end;
            *byte = ICDGEN_U8(*byte | (one ? icdgen_map_bit(map, bit) : 0u));
        }
    } else {
        icdgen_ask(procedure, ICD_TELEMETRY, map->messages[index].telemetry, true);
    }
}

/* Note which packets the node has. */
static inline void icdgen_mapped(icd_procedure_t *procedure)
{
    const icd_map_form_t *const map = procedure->form->blocks->map;
    const uint32_t bits = icdgen_map_bits(procedure), first = icdgen_map_index(procedure) * bits;
    for (uint32_t bit = 0; bit < bits && first + bit < procedure->count; ++bit) {
        const uint32_t at = ICDGEN_U32(map->at) + (bit / 8u);
        const uint32_t byte = at < procedure->frame_length ? procedure->frame[at] : 0u;
        icdgen_mark(procedure, first + bit, ((byte & ICDGEN_U32(icdgen_map_bit(map, bit))) != 0u) == map->received);
    }
}

/* ---- tests and entries ------------------------------------------------------------------------------------------- */

static inline bool icdgen_is_checksum(const icd_procedure_t *procedure, const icd_checksum_test_t *test)
{
    const icd_blocks_form_t *const blocks = procedure->form->blocks;
    const icd_procedure_memory_t *const memory = &procedure->memory;
    const uint32_t length = test->of_block ? procedure->registers[ICD_BLOCK_LENGTH] : ICDGEN_U32(memory->byte_count);
    const uint32_t all = test->of_block && test->covers_fill ? procedure->count * blocks->packet_bytes : length;
    const bool is_received = test->of_block && !blocks->sends;
    const uint8_t *const sent = memory->bytes;
    icdgen_check_t check;
    icdgen_check_begin(&check, test->algorithm);
    if (is_received) {
        icdgen_check_feed(&check, memory->buffer, ICDGEN_SIZE(all));
    } else if (length != 0u) {
        icdgen_check_feed(
            &check, sent + (test->of_block ? procedure->registers[ICD_BLOCK_OFFSET] : 0u), ICDGEN_SIZE(length));
    } else {
        /* there are no bytes */
    }
    for (uint32_t i = length; !is_received && i < all; ++i) {
        icdgen_check_feed(&check, &blocks->fill, 1);
    }
    return icdgen_check_result(&check) == icdgen_value(procedure, &test->value);
}

/* The telemetry is the next entry. If it is equal to the last one, the node did not advance. */
static inline void icdgen_collect(icd_procedure_t *procedure)
{
    const icd_procedure_memory_t *const memory = &procedure->memory;
    if (procedure->entries != 0u && procedure->frame_length == procedure->entry_length &&
        memcmp(procedure->frame, procedure->entry, procedure->frame_length) == 0) {
        procedure->repetitions++;
        if (procedure->repetitions > procedure->link->client.retries) {
            icdgen_end(procedure, ICD_TIMED_OUT);
            return;
        }
    } else if (procedure->entries == procedure->form->most_entries) {
        icdgen_end(procedure, ICD_LIMIT);
        return;
    } else {
        procedure->entries++;
        procedure->repetitions = 0;
        procedure->entry_length = procedure->frame_length;
        (void)memcpy(procedure->entry, procedure->frame, procedure->frame_length);
        if (memory->on_entry != NULL) {
            memory->on_entry(memory->context, procedure->entry, procedure->entry_length);
        }
    }
    icdgen_go_on(procedure);
}

static inline void icdgen_end_if_zeros(icd_procedure_t *procedure)
{
    uint8_t any = 0;
    for (size_t i = 0; i < procedure->frame_length; ++i) {
        any = ICDGEN_U8(any | procedure->frame[i]);
    }
    if (any == 0u) {
        icdgen_end(procedure, ICD_DONE);
    } else {
        icdgen_go_on(procedure);
    }
}

/* ---- the engine -------------------------------------------------------------------------------------------------- */

static inline void icdgen_run_step(icd_procedure_t *procedure)
{
    const icd_procedure_form_t *const form = procedure->form;
    const icd_step_form_t *const step = icdgen_step(procedure);
    switch (step->kind) {
    case ICD_STEP_SEND:
        icdgen_send_step(procedure, &form->sends[step->index]);
        break;
    case ICD_STEP_POLL:
        icdgen_poll_step(procedure, &form->polls[step->index]);
        break;
    case ICD_STEP_NEXT_BLOCK:
        icdgen_next_block(procedure, step->to);
        break;
    case ICD_STEP_SET_LENGTH:
        icdgen_set_length_step(procedure, icdgen_value(procedure, &form->tests[step->index].value));
        break;
    case ICD_STEP_NEXT_ROUND:
        icdgen_next_round(procedure, step->to);
        break;
    case ICD_STEP_NEXT_PACKET:
        icdgen_next_packet(procedure, step->to);
        break;
    case ICD_STEP_PACKET_DONE:
        icdgen_mark(procedure, procedure->cursor - 1u, true);
        icdgen_go_on(procedure);
        break;
    case ICD_STEP_SEND_MAP:
        icdgen_map_step(procedure, true);
        break;
    case ICD_STEP_GET_MAP:
        icdgen_map_step(procedure, false);
        break;
    case ICD_STEP_RECEIVE:
        icdgen_receive_step(procedure, &form->receives[step->index]);
        break;
    case ICD_STEP_VERIFY_CRC:
        if (icdgen_is_checksum(procedure, &form->checksums[step->index])) {
            icdgen_go_on(procedure);
        } else {
            icdgen_again(procedure, step->again, ICD_CHECKSUM);
        }
        break;
    case ICD_STEP_VERIFY:
        if (icdgen_holds(procedure, &form->tests[step->index])) {
            icdgen_go_on(procedure);
        } else {
            icdgen_again(procedure, step->again, ICD_FAILED);
        }
        break;
    case ICD_STEP_COLLECT:
        icdgen_collect(procedure);
        break;
    case ICD_STEP_END_IF_ZEROS:
        icdgen_end_if_zeros(procedure);
        break;
    case ICD_STEP_SKIP_UNLESS:
        if (icdgen_holds(procedure, &form->tests[step->index])) {
            icdgen_go_on(procedure);
        } else {
            icdgen_go_to(procedure, step->to);
        }
        break;
    case ICD_STEP_JUMP:
    default:
        icdgen_go_to(procedure, step->to);
        break;
    }
}

ICDGEN_API bool icd_procedure_next(icd_procedure_t *procedure, uint32_t now, icd_request_t *request)
{
    procedure->now = now;
    if (!procedure->is_started) {
        procedure->is_started = true;
        procedure->begin = now;
    }
    if (procedure->result == ICD_RUNNING && now - procedure->begin > procedure->form->time) {
        icdgen_end(procedure, ICD_LIMIT);
    }
    if (procedure->waits && icdgen_reached(now, procedure->until)) {
        procedure->waits = false;
    }
    while (procedure->result == ICD_RUNNING && !procedure->has_request && !procedure->waits) {
        if (procedure->at == procedure->form->step_count) {
            icdgen_end(procedure, ICD_DONE);
        } else {
            icdgen_run_step(procedure);
        }
    }
    if (!procedure->has_request || procedure->is_requested) {
        return false;
    }
    if (procedure->requests == procedure->form->requests) {
        icdgen_end(procedure, ICD_LIMIT);
        return false;
    }
    procedure->requests++;
    procedure->is_requested = true;
    *request = procedure->request;
    return true;
}

/* Keep telemetry. No message of a procedure is longer than the buffer. */
static inline void icdgen_keep_frame(icd_procedure_t *procedure, const uint8_t *data, size_t length)
{
    procedure->frame_length = length < ICD_STEP_BYTES ? length : ICD_STEP_BYTES;
    if (procedure->frame_length != 0u) {
        (void)memcpy(procedure->frame, data, procedure->frame_length);
    }
}

/* Process the outcome of the request. */
static inline void icdgen_outcome(icd_procedure_t *procedure, icd_result_t outcome, const uint8_t *data, size_t length)
{
    const icd_procedure_form_t *const form = procedure->form;
    const icd_step_form_t *const step = icdgen_step(procedure);
    const uint8_t kind = step->kind;
    if (!procedure->is_requested) {
        return;
    }
    procedure->has_request = false;
    procedure->is_requested = false;
    if (kind == ICDGEN_U8(ICD_STEP_RECEIVE)) {
        if (outcome == ICD_DONE) {
            icdgen_take_packet(procedure, &form->receives[step->index], data, length);
        }
        icdgen_count_request(procedure);
        return;
    }
    if (outcome != ICD_DONE &&
        !(outcome == ICD_TIMED_OUT && kind == ICDGEN_U8(ICD_STEP_SEND) && form->sends[step->index].ignores_timeout)) {
        icdgen_end(procedure, outcome);
        return;
    }
    if (procedure->request.direction == ICD_TELEMETRY && !procedure->has_reply) {
        icdgen_keep_frame(procedure, data, length);
    }
    if (kind == ICDGEN_U8(ICD_STEP_POLL)) {
        icdgen_polled(procedure, &form->polls[step->index]);
    } else if (kind == ICDGEN_U8(ICD_STEP_SEND)) {
        icdgen_go_on(procedure);
    } else {
        if (kind == ICDGEN_U8(ICD_STEP_GET_MAP)) {
            icdgen_mapped(procedure);
        }
        icdgen_count_request(procedure);
    }
}

/*
 * A negative acknowledge with a code that the ICD does not have is treated as damaged: a request that may be repeated
 * is sent again, any other is treated as if no acknowledge was received.
 */
static inline void icdgen_damaged(icd_procedure_t *procedure)
{
    if (procedure->request.repeat && procedure->damaged < procedure->link->client.retries) {
        procedure->damaged++;
        procedure->is_requested = false;
    } else {
        icdgen_outcome(procedure, ICD_TIMED_OUT, NULL, 0);
    }
}

static inline void icdgen_arrived(icd_procedure_t *procedure, uint32_t id, const uint8_t *data, size_t length)
{
    for (size_t i = 0; i < procedure->form->receive_count; ++i) {
        if (procedure->form->receives[i].id == id) {
            icdgen_take_packet(procedure, &procedure->form->receives[i], data, length);
        }
    }
}

ICDGEN_API void icd_procedure_event(icd_procedure_t *procedure, uint32_t now, const icd_event_t *event)
{
    const bool is_mine = procedure->is_requested && event->direction == procedure->request.direction &&
        event->id == procedure->request.id;
    procedure->now = now;
    if (procedure->result != ICD_RUNNING) {
        return;
    }
    if (event->kind == ICD_EVENT_ARRIVED) {
        icdgen_arrived(procedure, event->id, event->data, event->length);
    } else if (!is_mine) {
        /* of a request of the application */
    } else if (event->kind == ICD_EVENT_REPLY) {
        icdgen_keep_frame(procedure, event->data, event->length);
        procedure->has_reply = true;
    } else if (event->kind == ICD_EVENT_DONE || event->kind == ICD_EVENT_SENT) {
        icdgen_outcome(procedure, ICD_DONE, event->data, event->length);
    } else if (event->kind == ICD_EVENT_TIMEOUT) {
        icdgen_outcome(procedure, ICD_TIMED_OUT, NULL, 0);
    } else if (event->kind == ICD_EVENT_REFUSED && event->may_be_damaged) {
        icdgen_damaged(procedure);
    } else if (event->kind == ICD_EVENT_REFUSED) {
        icdgen_outcome(procedure, ICD_REFUSED, NULL, 0);
    } else if (event->kind == ICD_EVENT_BUSY) {
        icdgen_outcome(procedure, ICD_BUSY, NULL, 0);
    } else {
        /* not related to this procedure */
    }
}

ICDGEN_API bool icd_procedure_deadline(const icd_procedure_t *procedure, uint32_t *deadline)
{
    *deadline = procedure->until;
    return procedure->waits;
}

ICDGEN_API uint32_t icd_procedure_progress(const icd_procedure_t *procedure, uint32_t *total)
{
    *total = procedure->form->blocks != NULL ? icdgen_total(procedure) : ICD_UNKNOWN;
    return procedure->registers[ICD_BLOCK_OFFSET];
}

ICDGEN_API icd_status_t icd_procedure_step(icd_procedure_t *procedure, icd_client_t *client, uint32_t now)
{
    icd_request_t request;
    if (!icdgen_has_room(client) || !icd_procedure_next(procedure, now, &request)) {
        return ICD_OK;
    }
    return icd_client_start(client, now, &request);
}

/* ---- inputs ------------------------------------------------------------------------------------------------------ */

static inline bool icdgen_is_input(const icd_input_form_t *input, uint32_t number)
{
    bool is_value = input->values == NULL && number <= input->most;
    for (size_t i = 0; i < input->value_count; ++i) {
        is_value = is_value || number == input->values[i];
    }
    return is_value || (input->is_optional && number == ICD_UNKNOWN);
}

/* Return whether the memory is large enough for the blocks. */
static inline bool icdgen_has_memory(const icd_blocks_form_t *blocks, const icd_procedure_memory_t *memory)
{
    const uint32_t packets = icdgen_parts(memory->block, blocks->packet_bytes);
    return memory->bitmap_size >= icdgen_parts(packets, 8) &&
        (blocks->sends || memory->buffer_size >= ICDGEN_SIZE(packets) * blocks->packet_bytes);
}

ICDGEN_API icd_status_t icd_procedure_init(
    icd_procedure_t *procedure,
    const icd_link_t *link,
    const icd_procedure_form_t *form,
    icd_bus_t bus,
    const uint32_t *inputs,
    const icd_procedure_memory_t *memory)
{
    (void)memset(procedure, 0, sizeof *procedure);
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    procedure->link = link;
    procedure->form = form;
    procedure->bus = bus;
    procedure->memory = *memory;
    for (size_t i = 0; i < form->input_count; ++i) {
        if (!icdgen_is_input(&form->inputs[i], inputs[i])) {
            return ICD_ERROR_RANGE;
        }
        procedure->registers[ICDGEN_SIZE(ICD_FIRST_INPUT) + i] = inputs[i];
    }
    if (memory->byte_count > form->most_bytes) {
        return ICD_ERROR_LENGTH;
    }
    if (form->blocks != NULL) {
        const uint32_t size = form->blocks->size;
        procedure->memory.block = memory->block != 0u && memory->block < size ? memory->block : size;
        if (!icdgen_has_memory(form->blocks, &procedure->memory)) {
            return ICD_ERROR_LENGTH;
        }
    }
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_PROCEDURE_C */
