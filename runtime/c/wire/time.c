#ifndef ICDGEN_WIRE_TIME_C
#define ICDGEN_WIRE_TIME_C

#include "time.h"

ICDGEN_API const char *icd_dos_time_wrong(const icd_dos_time_t *time)
{
    static const uint8_t month_days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    unsigned days;
    if (time->month < 1u || time->month > 12u) {
        return "month";
    }
    days = month_days[time->month - 1u];
    if (time->month == 2u && ((time->year % 4u == 0u && time->year % 100u != 0u) || time->year % 400u == 0u)) {
        days++;
    }
    return time->day < 1u || time->day > days ? "day"
        : time->hour > 23u                    ? "hour"
        : time->minute > 59u                  ? "minute"
        : time->second > 59u                  ? "second"
                                              : NULL;
}

static inline uint16_t icdgen_time_get(icd_time_part_t part, uint32_t value)
{
    const uint32_t raw = (value >> part.at) & ((UINT32_C(1) << part.bits) - 1u);
    return ICDGEN_U16((raw * part.factor) + part.offset);
}

static inline bool icdgen_time_put(icd_time_part_t part, uint32_t given, uint32_t *value)
{
    const uint32_t raw = (given - part.offset) / part.factor;
    *value |= raw << part.at;
    return given >= part.offset && (raw >> part.bits) == 0u;
}

ICDGEN_API icd_status_t icd_dos_time_unpack(const icd_link_t *link, uint32_t value, icd_dos_time_t *time)
{
    const icd_time_form_t *const form = link->time;
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    time->year = icdgen_time_get(form->year, value);
    time->month = icdgen_time_get(form->month, value);
    time->day = icdgen_time_get(form->day, value);
    time->hour = icdgen_time_get(form->hour, value);
    time->minute = icdgen_time_get(form->minute, value);
    time->second = icdgen_time_get(form->second, value);
    return ICD_OK;
}

ICDGEN_API icd_status_t
icd_dos_time_pack(const icd_link_t *link, const icd_dos_time_t *time, uint32_t *value, const char **wrong)
{
    const icd_time_form_t *const form = link->time;
    uint32_t packed = 0;
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    *wrong = icd_dos_time_wrong(time);
    if (*wrong == NULL) {
        *wrong = !icdgen_time_put(form->year, time->year, &packed)  ? "year"
            : !icdgen_time_put(form->month, time->month, &packed)   ? "month"
            : !icdgen_time_put(form->day, time->day, &packed)       ? "day"
            : !icdgen_time_put(form->hour, time->hour, &packed)     ? "hour"
            : !icdgen_time_put(form->minute, time->minute, &packed) ? "minute"
            : !icdgen_time_put(form->second, time->second, &packed) ? "second"
                                                                    : NULL;
    }
    if (*wrong != NULL) {
        return ICD_ERROR_RANGE;
    }
    *value = packed;
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_TIME_C */
