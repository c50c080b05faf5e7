/* Numbers as text, for the records of writers: some ten times as fast as printf, and with a
 * point in any locale. Each function returns the end of its output. */
#ifndef FORMATS_TEXT_NUMBER_FORMAT_H
#define FORMATS_TEXT_NUMBER_FORMAT_H

#include <cubewright/core.h>

#include <string.h>

/* Puts a decimal like "%.*g", except for the last digit of a tie. 9 digits bring a float back
 * to the bit, 17 a double. Takes up to 24 bytes; there is no negative zero. */
unsigned char *cwi_put_decimal(unsigned char *to, double value, int digits);
unsigned char *cwi_put_integer(unsigned char *to, uint64_t value);

enum { CWI_NUMBER_BYTES = 26, CWI_POINT_BYTES = 3 * CWI_NUMBER_BYTES };

/* Prints "1.5" or "1 2 3.5": the shortest digits that read back the same, and a terminating
 * zero. */
void cwi_print_number(double value, char text[CWI_NUMBER_BYTES]);
void cwi_print_point(const double point[3], char text[CWI_POINT_BYTES]);

static inline unsigned char *cwi_put_text(unsigned char *to, const char *text)
{
    const size_t size = strlen(text);
    memcpy(to, text, size);
    return to + size;
}

/* Puts three numbers with blanks between them. */
static inline unsigned char *cwi_put_decimals(unsigned char *to, const double values[3],
                                              int digits)
{
    for (int i = 0; i < 3; i++) {
        if (i > 0)
            *to++ = ' ';
        to = cwi_put_decimal(to, values[i], digits);
    }
    return to;
}

static inline unsigned char *cwi_put_singles(unsigned char *to, const float values[3])
{
    double exact[3];
    for (int i = 0; i < 3; i++)
        exact[i] = (double)values[i];
    return cwi_put_decimals(to, exact, 9);
}

#endif
