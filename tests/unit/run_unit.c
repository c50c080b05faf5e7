/* The test program of a room: run with the name of a file of tests, runs those; without one, all. */
#include <stdio.h>
#include <string.h>

#define UNIT(name) int run_##name(void); /* its main, renamed by CMake */
#include "units.inc"
#undef UNIT

#define UNIT(name) {#name, run_##name},
static const struct {
    const char *name;
    int (*run)(void);
} units[] = {
#include "units.inc"
};

int main(int argc, char **argv)
{
    const size_t count = sizeof units / sizeof *units;
    int failed = 0, found = 0;
    for (size_t n = 0; n < count; n++)
        if (argc < 2 || strcmp(argv[1], units[n].name) == 0) {
            found++;
            failed += units[n].run() != 0;
        }
    if (found == 0)
        fprintf(stderr, "%s: there are no tests named %s\n", argv[0], argv[1]);
    return failed > 0 || found == 0;
}
