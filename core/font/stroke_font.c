/* A font of strokes, drawn for this library on a grid: capitals and digits stand on rows 0 to
 * 6, small letters on 2 to 6 and down to 8. A figure is lines through points, two digits x and
 * y each; a space starts another line; a point alone is a dot. */
#include "core/font/stroke_font.h"

#include <stdbool.h>
#include <string.h>

typedef struct glyph {
    uint32_t character;
    const char *lines;
} glyph;

static const glyph glyphs[] = {
    {'0', "103041453616050110 2323"},
    {'1', "012026 0646"},
    {'2', "01103041420646"},
    {'3', "0110304142334445361605 2333"},
    {'4', "36300444"},
    {'5', "400003334445361605"},
    {'6', "413010010516364544331304"},
    {'7', "00404116"},
    {'8', "13020110304142331304051636454433"},
    {'9', "051636454130100102133342"},
    {'A', "062046 1434"},
    {'B', "00063645443303 0030414233"},
    {'C', "4130100105163645"},
    {'D', "00063645413000"},
    {'E', "40000646 0333"},
    {'F', "400006 0333"},
    {'G', "41301001051636454323"},
    {'H', "0006 4046 0343"},
    {'I', "0020 1016 0626"},
    {'J', "4045361605"},
    {'K', "0006 4004 1346"},
    {'L', "000646"},
    {'M', "0600234046"},
    {'N', "06004640"},
    {'O', "104051554616050110"},
    {'P', "06003041423303"},
    {'Q', "104051554616050110 3456"},
    {'R', "06003041423303 2346"},
    {'S', "413010010213334445361605"},
    {'T', "0040 2026"},
    {'U', "000516364540"},
    {'V', "002640"},
    {'W', "0016223640"},
    {'X', "0046 4006"},
    {'Y', "002340 2326"},
    {'Z', "00400646"},
    {'a', "4246 4332120305163645"},
    {'b', "0006 0312324345361605"},
    {'c', "4332120305163645"},
    {'d', "4046 4332120305163645"},
    {'e', "04444332120305163645"},
    {'f', "30201116 0232"},
    {'g', "4247381807 4332120305163645"},
    {'h', "0006 0312324346"},
    {'i', "0206 0000"},
    {'j', "121708 1010"},
    {'k', "0006 3205 1436"},
    {'l', "000516"},
    {'m', "0206 03122326 23324346"},
    {'n', "0206 0312324346"},
    {'o', "123243453616050312"},
    {'p', "0208 0312324345361605"},
    {'q', "4248 4332120305163645"},
    {'r', "0206 03122232"},
    {'s', "43321203143445361605"},
    {'t', "10152636 0232"},
    {'u', "0205163645 4246"},
    {'v', "022642"},
    {'w', "0216233642"},
    {'x', "0246 4206"},
    {'y', "0226 4218"},
    {'z', "02420646"},
    {'.', "0606"},
    {',', "1608"},
    {':', "0303 0606"},
    {';', "1313 1608"},
    {'!', "0004 0606"},
    {'?', "01103041422324 2626"},
    {'\'', "0001"},
    {'"', "0001 2021"},
    {'-', "0434"},
    {'+', "2226 0444"},
    {'*', "2125 0244 4204"},
    {'/', "4006"},
    {'\\', "0046"},
    {'%', "4006 0101 4545"},
    {'=', "0343 0545"},
    {'<', "420446"},
    {'>', "024406"},
    {'(', "10020416"},
    {')', "00121406"},
    {'[', "10000616"},
    {']', "00101606"},
    {'|', "0007"},
    {'_', "0747"},
    {'#', "1016 3036 0242 0444"},
    {'~', "05143544"},
    {0x00b0, "102031322313020110"}, /* degree */
    {0x00b2, "0010210323"},         /* to the power of two */
    {0x00b5, "0208 05163645 4246"}, /* micro */
    {0x00b7, "0404"},               /* middle dot */
    {0x00d7, "1335 3315"},          /* times */
    {0x2212, "0444"},               /* minus */
    {0x0394, "06204606"},           /* Delta */
};

static const char missing[] = "0040460600";

static const char *find_glyph(uint32_t character)
{
    for (size_t n = 0; n < sizeof glyphs / sizeof *glyphs; n++)
        if (glyphs[n].character == character)
            return glyphs[n].lines;
    return NULL;
}

static size_t read_lines(const char *lines, cwi_stroke *strokes, double *width)
{
    size_t count = 0;
    double last[2] = {0};
    bool starts = true, is_dot = false;
    *width = 0;
    for (; *lines; lines += *lines == ' ' ? 1 : 2) {
        if (*lines == ' ') {
            starts = true;
            continue;
        }
        const double p[2] = {lines[0] - '0', lines[1] - '0'};
        if (starts || !is_dot) /* else this point is the other end of the stroke */
            count++;
        cwi_stroke *s = &strokes[count - 1];
        memcpy(s->from, starts ? p : last, sizeof p);
        memcpy(s->to, p, sizeof p);
        is_dot = starts;
        starts = false;
        memcpy(last, p, sizeof p);
        *width = p[0] > *width ? p[0] : *width;
    }
    return count;
}

size_t cwi_missing_glyph(cwi_stroke strokes[CWI_GLYPH_STROKES], double *width)
{
    return read_lines(missing, strokes, width);
}

size_t cwi_glyph(uint32_t character, cwi_stroke strokes[CWI_GLYPH_STROKES], double *width)
{
    const char *lines = find_glyph(character);
    *width = 0;
    return lines ? read_lines(lines, strokes, width) : 0;
}

uint32_t cwi_next_character(const char **text)
{
    const unsigned char *t = (const unsigned char *)*text;
    const int more = t[0] < 0x80 ? 0 : t[0] >> 5 == 6 ? 1 : t[0] >> 4 == 14 ? 2 : -1;
    uint32_t c = more == 0 ? t[0] : more == 1 ? t[0] & 31u : t[0] & 15u;
    ++*text;
    for (int n = 1; n <= more; n++) {
        if (t[n] >> 6 != 2)
            return 0xfffd;
        c = c << 6 | (t[n] & 63u);
        ++*text;
    }
    return more < 0 ? 0xfffd : c;
}
