/* Text, pictures and numbers as HTML that is XML, too. */
#define _DEFAULT_SOURCE /* strsep */
#include "cli/report/page.h"

#include "core/base/memory.h"
#include "core/base/text.h"

#include <stdio.h>
#include <string.h>

/* Bytes that are no text, and control characters, would be taken for something else. */
void cli_put_html(FILE *out, const char *text)
{
    while (*text) {
        const size_t n = cwi_utf8_length(text);
        const unsigned char byte = (unsigned char)*text;
        if (n == 0 || byte == 0x7f || (byte < 0x20 && byte != '\n'))
            fputs("\xef\xbf\xbd", out);
        else if (byte == '<' || byte == '>' || byte == '&' || byte == '"' || byte == '\'')
            fprintf(out, "&#%d;", byte);
        else
            fwrite(text, 1, n, out);
        text += n ? n : 1;
    }
}

void cli_put_base64(FILE *out, const char *bytes, size_t size)
{
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t n = 0; n < size; n += 3) {
        const size_t left = size - n;
        const unsigned a = (unsigned char)bytes[n],
                       b = left > 1 ? (unsigned char)bytes[n + 1] : 0,
                       c = left > 2 ? (unsigned char)bytes[n + 2] : 0;
        const unsigned word = a << 16 | b << 8 | c;
        fputc(digits[word >> 18], out);
        fputc(digits[word >> 12 & 63], out);
        fputc(left > 1 ? digits[word >> 6 & 63] : '=', out);
        fputc(left > 2 ? digits[word & 63] : '=', out);
    }
}

void cli_put_image(FILE *out, const cli_png *png, const char *alt)
{
    if (!png->bytes)
        return;
    fputs("<img alt=\"", out);
    cli_put_html(out, alt);
    fputs("\" src=\"data:image/png;base64,", out);
    cli_put_base64(out, png->bytes, png->size);
    fputs("\"/>", out);
}

/* Each word is an element, so that lines end at blanks and not behind the dash of an option. */
void cli_put_code(FILE *out, const char *command)
{
    char *copy = cwi_strdup(command), *rest = copy, *word;
    fputs("<code data-copy=\"\">", out);
    while (rest && (word = strsep(&rest, " ")) != NULL) {
        fputs("<span>", out);
        cli_put_html(out, word);
        fputs(rest ? "</span> " : "</span>", out);
    }
    fputs("</code>", out);
    cwi_free(copy);
}

void cli_put_fact(FILE *out, const char *name, const char *value)
{
    fputs("<div><dt>", out);
    cli_put_html(out, name);
    fputs("</dt><dd>", out);
    cli_put_html(out, value);
    fputs("</dd></div>", out);
}

enum { TEXTS = 4, TEXT_CAPACITY = 48 };

static char *next_text(void)
{
    static char text[TEXTS][TEXT_CAPACITY];
    static int turn;
    return text[turn++ % TEXTS];
}

const char *cli_seconds_text(double seconds)
{
    char *text = next_text();
    if (seconds < 1)
        snprintf(text, TEXT_CAPACITY, "%.3g ms", 1e3 * seconds);
    else
        snprintf(text, TEXT_CAPACITY, "%.3g s", seconds);
    return text;
}

const char *cli_runs_text(const cli_point *p)
{
    char *text = next_text();
    if (p->runs < 2)
        return "1 run";
    snprintf(text, TEXT_CAPACITY, "median of %zu", p->runs);
    return text;
}
