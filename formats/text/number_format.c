/* Prints numbers as text without printf: integers, decimals of given digits, and shortest
 * forms. */
#include "formats/text/number_format.h"

#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LONGEST = 25, MAX_DIGITS = 15 };

/* Powers of ten that a double holds exactly. */
static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
                              1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19};

static unsigned char *print_number(unsigned char *to, double value, int digits)
{
    void *before = cwi_locale_c();
    to += snprintf((char *)to, LONGEST, "%.*g", digits, value);
    cwi_locale_restore(before);
    return to;
}

unsigned char *cwi_put_integer(unsigned char *to, uint64_t value)
{
    unsigned char digits[20];
    int count = 0;
    do
        digits[count++] = (unsigned char)('0' + value % 10);
    while (value /= 10);
    while (count > 0)
        *to++ = digits[--count];
    return to;
}

/* Puts the digits behind the point, without trailing zeros. */
static unsigned char *put_fraction(unsigned char *to, uint64_t fraction, int places)
{
    for (; fraction % 10 == 0; fraction /= 10)
        places--;
    unsigned char *end = to + places;
    for (int i = places - 1; i >= 0; i--, fraction /= 10)
        to[i] = (unsigned char)('0' + fraction % 10);
    return end;
}

/* Puts a decimal. All digits become one whole number by one product. The product is off by 1e-7
 * of a digit at most: far less than the difference of two floats. */
unsigned char *cwi_put_decimal(unsigned char *to, double value, int digits)
{
    const double size = fabs(value);
    if (size == 0) {
        *to = '0';
        return to + 1;
    }
    if (digits > MAX_DIGITS || !(size >= 1e-4 && size < tens[digits]))
        return print_number(to, value, digits);
    int places = digits + 3;
    while (size * 1e4 >= tens[digits + 4 - places])
        places--;
    const uint64_t all = (uint64_t)llrint(size * tens[places]);
    const uint64_t unit = (uint64_t)tens[places];
    if (value < 0)
        *to++ = '-';
    to = cwi_put_integer(to, all / unit);
    if (all % unit == 0)
        return to;
    *to++ = '.';
    return put_fraction(to, all % unit, places);
}

void cwi_print_number(double value, char text[CWI_NUMBER_BYTES])
{
    void *before = cwi_locale_c();
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, CWI_NUMBER_BYTES, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    cwi_locale_restore(before);
}

void cwi_print_point(const double point[3], char text[CWI_POINT_BYTES])
{
    for (int a = 0; a < 3; a++) {
        if (a > 0)
            *text++ = ' ';
        cwi_print_number(point[a], text);
        text += strlen(text);
    }
}
