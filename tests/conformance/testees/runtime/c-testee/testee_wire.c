/* What all requests about the wire layer share; checksums, what the link says, and the identity. */

#include "testee_wire.h"

const icd_link_t *next_link(void)
{
    return testee_link(next_number());
}

icd_bus_t next_bus(void)
{
    const char *word = next_word();
    return is_word(word, "uart") ? ICD_BUS_UART : is_word(word, "i2c") ? ICD_BUS_I2C : ICD_BUS_CAN;
}

const char *event_name(icd_event_kind_t kind)
{
    static const char *const names[] = {
        "message",        "gap",     "checksum",     "length",
        "unknown_id",     "overrun", "framing",      "unexpected_start",
        "protocol_error", "empty",   "duplicate",    "incomplete",
        "malformed",      "busy",    "unknown_type", "unchecked",
        "request",        "packet",  "done",         "sent",
        "refused",        "busy",    "timeout",      "progress",
        "reply",          "arrived", "log",          "late",
        "stray",
    };
    return names[kind];
}

static void checksum(void)
{
    const size_t node = next_number();
    const icd_checksum_algorithm_t *const algorithm = testee_checksum(node, next_word());
    const octets_t octets = next_octets();
    if (answers(algorithm != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED)) {
        put_number("crc", icd_checksum(algorithm, octets.data, octets.length));
    }
}

void put_known(const char *key, int64_t number)
{
    if (number >= 0) {
        put_signed(key, number);
    }
}

static void link_data(void)
{
    const icd_link_t *link = next_link();
    if (answers(link != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED)) {
        put_known("boot_ms", link->boot_ms);
        put_known("log_file_type", link->log_file != NULL ? link->log_file->file_type : -1);
        put_known("index_file_type", link->index != NULL ? link->index->file_type : -1);
    }
}

static void identify(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    icd_identity_t identity = {0, 0, false};
    const icd_status_t status = icd_identify(link, octets.data, octets.length, &identity);
    if (status == ICD_ERROR_LENGTH) {
        refuse_length("length", link->identification->length, octets.length);
    } else if (answers(status)) {
        put_number("node_type", identity.node_type);
        put_number("interface_version", identity.interface_version);
        put_number("matches", identity.matches);
    }
}

const testee_op_t testee_wire_ops[] = {
    {"checksum", checksum},
    {"link_data", link_data},
    {"identify", identify},
    {NULL, NULL},
};
