#define _GNU_SOURCE /* strtod_l, newlocale */
#include "core/text.h"

#include <errno.h>
#include <locale.h>
#include <pthread.h>
#include <stdlib.h>

static locale_t c_locale;
static pthread_once_t c_locale_once = PTHREAD_ONCE_INIT;

static void make_c_locale(void)
{
    c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
}

/* The C locale is always there; (locale_t)0 after memory ran out leaves the program's own. */
static locale_t get_c_locale(void)
{
    pthread_once(&c_locale_once, make_c_locale);
    return c_locale;
}

bool cwi_parse_double(const char **text, double *value)
{
    char *end;
    const locale_t c = get_c_locale();
    const double v = c ? strtod_l(*text, &end, c) : strtod(*text, &end);
    if (end == *text)
        return false;
    *text = end;
    *value = v;
    return true;
}

bool cwi_parse_int(const char **text, int64_t *value)
{
    char *end;
    errno = 0;
    const long long v = strtoll(*text, &end, 10);
    if (end == *text || errno == ERANGE)
        return false;
    *text = end;
    *value = v;
    return true;
}

void *cwi_locale_c(void)
{
    const locale_t c = get_c_locale();
    return c ? (void *)uselocale(c) : NULL;
}

void cwi_locale_restore(void *before)
{
    if (before)
        uselocale((locale_t)before);
}

size_t cwi_utf8_length(const char *text)
{
    static const uint32_t lowest[5] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *s = (const unsigned char *)text;
    const size_t n = s[0] < 0x80       ? 1
                     : s[0] >> 5 == 6  ? 2
                     : s[0] >> 4 == 14 ? 3
                     : s[0] >> 3 == 30 ? 4
                                       : 0;
    uint32_t code = n > 1 ? s[0] & (0x7fu >> n) : s[0];
    for (size_t i = 1; i < n; i++) {
        if (s[i] >> 6 != 2)
            return 0;
        code = code << 6 | (s[i] & 0x3f);
    }
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    return n && code >= lowest[n] && code < 0x110000 && !surrogate ? n : 0;
}
