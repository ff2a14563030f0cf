/* Runs the libFuzzer harness on inputs from standard input, each after its length in two bytes: for compilers without libFuzzer. */

#include <stdint.h>
#include <stdio.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int main(void)
{
    static uint8_t data[65536];
    unsigned long inputs = 0;
    int low, high;
    while ((low = getchar()) != EOF && (high = getchar()) != EOF) {
        const size_t size = (size_t)low + (size_t)high * 256u;
        if (fread(data, 1, size, stdin) != size) {
            return 2;
        }
        (void)LLVMFuzzerTestOneInput(data, size);
        inputs++;
    }
    printf("%lu inputs\n", inputs);
    return 0;
}
