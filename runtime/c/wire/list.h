#ifndef ICDGEN_WIRE_LIST_H
#define ICDGEN_WIRE_LIST_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "sizes.h"
#include "procedure.h"

/** A file of the node. `size` is in bytes; `time` is packed, see icd_dos_time_unpack(). */
typedef struct {
    uint32_t type;
    uint32_t counter;
    uint32_t size;
    uint32_t time;
    uint32_t checksum;
} icd_file_t;

/** Callback for each file. `file` is valid during the call. */
typedef void icd_file_fn(void *context, const icd_file_t *file);

/** Listing of the files. Pass `&list.procedure` to the icd_procedure_...() functions. */
typedef struct {
    icd_procedure_t procedure;
    icd_file_fn *on_file;
    void *context;
    uint32_t count; /* files passed to `on_file` */
    uint32_t again; /* number of identical frames in a row */
    bool has_last;
    uint8_t last[ICD_STEP_BYTES];
} icd_list_t;

ICDGEN_API icd_status_t icd_list_init(icd_list_t *list, const icd_link_t *link, icd_file_fn *on_file, void *context);

#endif /* ICDGEN_WIRE_LIST_H */
