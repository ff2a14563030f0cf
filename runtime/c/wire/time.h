#ifndef ICDGEN_WIRE_TIME_H
#define ICDGEN_WIRE_TIME_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"

/* ---- packed time ------------------------------------------------------------------------------------------------- */

/** A date and time of day. */
typedef struct {
    uint16_t year;
    uint16_t month;
    uint16_t day;
    uint16_t hour;
    uint16_t minute;
    uint16_t second;
} icd_dos_time_t;

/** The name of the first part that the calendar or the clock does not have; NULL if all is well. */
ICDGEN_API const char *icd_dos_time_wrong(const icd_dos_time_t *time);

/** Unpacks a time, whatever it is; icd_dos_time_wrong() tells whether it exists. */
ICDGEN_API icd_status_t icd_dos_time_unpack(const icd_link_t *link, uint32_t value, icd_dos_time_t *time);

/**
 * Packs a time; what is finer than its resolution is cut off. ICD_ERROR_RANGE, with the name of the first part that
 * does not exist or does not fit in `wrong`.
 */
ICDGEN_API icd_status_t
icd_dos_time_pack(const icd_link_t *link, const icd_dos_time_t *time, uint32_t *value, const char **wrong);

#endif /* ICDGEN_WIRE_TIME_H */
