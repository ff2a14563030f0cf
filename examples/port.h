/* A TCP port and a clock on POSIX for the example programs. Your driver and clock replace them. */
#ifndef PORT_H
#define PORT_H

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "icdgen_wire.h"

/* Milliseconds of a clock that never goes back. */
static inline uint32_t port_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)now.tv_sec * 1000u + (uint32_t)(now.tv_nsec / 1000000);
}

static inline void port_failed(const char *what)
{
    perror(what);
    exit(EXIT_FAILURE);
}

/* Connects, or exits with an error. */
static inline int port_open(const char *host, const char *number)
{
    const int one = 1, port = socket(AF_INET, SOCK_STREAM, 0);
    struct sockaddr_in address;
    memset(&address, 0, sizeof address);
    address.sin_family = AF_INET;
    address.sin_port = htons((uint16_t)atoi(number));
    if (inet_pton(AF_INET, host, &address.sin_addr) != 1) {
        fprintf(stderr, "%s: not an IPv4 address\n", host);
        exit(EXIT_FAILURE);
    }
    if (port < 0 || connect(port, (const struct sockaddr *)&address, sizeof address) != 0) {
        port_failed("cannot connect");
    }
    setsockopt(port, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    return port;
}

/* Sends the bytes. */
static inline void port_write(int port, const uint8_t *bytes, size_t count)
{
    while (count != 0) {
        const ssize_t sent = write(port, bytes, count);
        if (sent < 0) {
            port_failed("cannot send");
        }
        bytes += sent;
        count -= (size_t)sent;
    }
}

/* Waits for bytes until the time `until`. Returns their number; 0: none came. */
static inline size_t port_read(int port, uint8_t *bytes, size_t capacity, uint32_t until)
{
    struct pollfd ready = {port, POLLIN, 0};
    const int32_t left = (int32_t)(until - port_now());
    ssize_t got = 0;
    if (poll(&ready, 1, left > 0 ? left : 0) > 0) {
        got = read(port, bytes, capacity);
        if (got <= 0) {
            fprintf(stderr, "the connection is closed\n");
            exit(EXIT_FAILURE);
        }
    }
    return (size_t)got;
}

/* Sends all that the client has to send. */
static inline void port_send(int port, icd_client_t *client)
{
    uint8_t bytes[1024];
    size_t count;
    while (icd_client_output(client, bytes, sizeof bytes, &count)) {
        port_write(port, bytes, count);
    }
}

/* Waits for bytes until the time `until`, and passes them, or the time alone, to the client. */
static inline void port_receive(int port, icd_client_t *client, uint32_t until, icd_event_fn *on_event, void *context)
{
    uint8_t input[4096];
    const size_t count = port_read(port, input, sizeof input, until);
    icd_client_received(client, port_now(), input, count, on_event, context);
}

/* The outcome of a request: an event, with a copy of its data. */
typedef struct {
    icd_event_t event;
    bool ended;
    uint8_t *frame;
    size_t capacity;
} port_outcome_t;

static inline void port_on_event(void *context, const icd_event_t *event)
{
    port_outcome_t *const outcome = (port_outcome_t *)context;
    const bool ends = event->kind == ICD_EVENT_DONE || event->kind == ICD_EVENT_SENT ||
        event->kind == ICD_EVENT_REFUSED || event->kind == ICD_EVENT_BUSY || event->kind == ICD_EVENT_TIMEOUT;
    if (ends && event->length <= outcome->capacity) {
        outcome->event = *event;
        outcome->event.data = outcome->frame;
        outcome->ended = true;
        if (event->length != 0) {
            memcpy(outcome->frame, event->data, event->length);
        }
    }
}

/* Sends the pending request and waits for its outcome, whose data are copied to `frame`. */
static inline icd_event_t port_ask(int port, icd_client_t *client, uint8_t *frame, size_t capacity)
{
    port_outcome_t outcome;
    uint32_t deadline;
    memset(&outcome, 0, sizeof outcome);
    outcome.frame = frame;
    outcome.capacity = capacity;
    port_send(port, client);
    while (!outcome.ended && icd_client_deadline(client, &deadline)) {
        port_receive(port, client, deadline, port_on_event, &outcome);
        port_send(port, client);
    }
    return outcome.event;
}

#endif /* PORT_H */
