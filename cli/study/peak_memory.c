/* Measures the peak memory of a piece of work. The kernel counts the maximum that a process
 * used, and Linux lets this count be reset. */
#include "cli/study/study.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <stdio.h>
#include <string.h>

/* In bytes, a line of /proc/self/status such as "VmHWM:    1234 kB"; 0: there is none. */
static size_t status_bytes(const char *key)
{
    char line[128];
    size_t kilobytes = 0;
    FILE *f = fopen("/proc/self/status", "r");
    while (f && fgets(line, sizeof line, f))
        if (strncmp(line, key, strlen(key)) == 0 &&
            sscanf(line + strlen(key), " %zu", &kilobytes) == 1)
            break;
    if (f)
        fclose(f);
    return kilobytes * 1024;
}

static bool forget_peak(void)
{
    FILE *f = fopen("/proc/self/clear_refs", "w");
    if (!f)
        return false;
    const bool written = fputs("5", f) >= 0;
    return fclose(f) == 0 && written;
}

/* Returns freed memory to the system first. Otherwise work that reuses it would seem to take
 * none. */
cli_watch cli_watch_memory(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    cli_watch watch = {.before = status_bytes("VmRSS:")};
    watch.works = watch.before && forget_peak();
    return watch;
}

size_t cli_watched_bytes(const cli_watch *watch)
{
    const size_t peak = watch->works ? status_bytes("VmHWM:") : 0;
    return peak > watch->before ? peak - watch->before : 0;
}
