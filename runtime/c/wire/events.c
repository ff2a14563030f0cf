#ifndef ICDGEN_WIRE_EVENTS_C
#define ICDGEN_WIRE_EVENTS_C

#include "events.h"

static inline void icdgen_event_init(icd_event_t *event, icd_event_kind_t kind)
{
    (void)memset(event, 0, sizeof *event);
    event->kind = kind;
}

static inline void icdgen_event_of(icd_event_t *event, icd_event_kind_t kind, uint32_t id)
{
    icdgen_event_init(event, kind);
    event->has_id = true;
    event->id = id;
}

/* The event callback of a caller. */
typedef struct {
    icd_event_fn *on_event;
    void *context;
} icdgen_caller_t;

/* What a decoder calls for each event. A client completes the event, and hands it over to the caller. */
typedef struct {
    void (*tell)(const void *context, icd_event_t *event);
    const void *context;
} icdgen_listener_t;

static inline void icdgen_tell(const icdgen_listener_t *listener, icd_event_t *event)
{
    listener->tell(listener->context, event);
}

/* Hand an event over to the caller, without a client. */
static inline void icdgen_tell_caller(const void *context, icd_event_t *event)
{
    const icdgen_caller_t *const caller = ICDGEN_CAST(const icdgen_caller_t *, context);
    caller->on_event(caller->context, event);
}

/* Return whether a time is reached. Times may wrap around. */
static inline bool icdgen_reached(uint32_t now, uint32_t time)
{
    return now - time < UINT32_C(0x80000000);
}

#endif /* ICDGEN_WIRE_EVENTS_C */
