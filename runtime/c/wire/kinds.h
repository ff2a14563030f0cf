#ifndef ICDGEN_WIRE_KINDS_H
#define ICDGEN_WIRE_KINDS_H

#include "../icdgen.h"

/* Kinds of parts that the links of these nodes have, as masks. A compiler leaves out the code for other kinds. */

/* Of icd_delimiter_t. */
#define ICDGEN_DELIMITERS 0x3Fu

/* Of icd_check_kind_t. */
#define ICDGEN_CHECKS 0x1Fu

/* Of icd_packet_content_t. */
#define ICDGEN_CONTENTS 0x0Fu

/* Of icd_field_role_t. */
#define ICDGEN_ROLES 0x1FFFu

/* Flags of messages in packets. */
#define ICDGEN_STREAM_FLAGS 0x1Fu

/* Of icd_verdict_t. */
#define ICDGEN_VERDICTS 0x3Fu

/* Parts of responses. */
#define ICDGEN_RESPONSES 0x1Fu

/* Of icd_bus_t. */
#define ICDGEN_BUSES 0x7u

/* Holds the number of data bytes that any length field says. */
typedef int64_t icdgen_length_t;

#endif /* ICDGEN_WIRE_KINDS_H */
