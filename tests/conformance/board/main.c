/* Runs the self-test of every node; the last line of the output is JSON with the totals. */

#include "icdgen_selftest.h"

#include <stdio.h>

static void report(void *context, const icdgen_selftest_failure_t *failure)
{
    unsigned *left = (unsigned *)context;
    if (*left != 0u) {
        *left -= 1u;
        printf(
            "%s \"%s\" %s: %s, vector %lu\n", failure->node, failure->message,
            failure->field != NULL ? failure->field : "", failure->what, (unsigned long)failure->vector);
    }
}

int main(void)
{
    icdgen_selftest_totals_t totals = {0, 0, 0, 0};
    unsigned left = 20;
    size_t i;
    for (i = 0; i < icdgen_selftest_node_count; i++) {
        icdgen_selftest(icdgen_selftest_nodes[i], &totals, report, &left);
    }
    printf(
        "{\"messages\": %lu, \"vectors\": %lu, \"checks\": %lu, \"failures\": %lu}\n", (unsigned long)totals.messages,
        (unsigned long)totals.vectors, (unsigned long)totals.checks, (unsigned long)totals.failures);
    return totals.failures != 0u;
}
