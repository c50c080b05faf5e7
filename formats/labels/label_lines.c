/* Reads tables of labels that have a line for each: FreeSurfer, 3D Slicer, ITK-SNAP, and plain
 * lists of numbers and names. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/label_table.h"
#include "formats/labels/label_file.h"

#include <math.h>
#include <string.h>

enum { MAX_WORDS = 8, COLOR_WORDS = 5 };

/* Reads a line into a label, whose texts stay in the line. */
typedef cw_status line_reader(char *line, size_t number, cw_label *label, cw_error *err);

static cw_status read_lines(cwi_label_file *file, line_reader *read, cw_label_table *table,
                            cw_error *err)
{
    cwi_label_lines lines = {.next = file->text};
    cw_status st = CW_OK;
    for (char *line; st == CW_OK && (line = cwi_label_line(&lines));) {
        cw_label label = {0};
        st = read(line, lines.number, &label, err);
        if (st == CW_OK)
            st = cwi_label_table_append(table, &label, err);
    }
    return st == CW_OK ? cwi_label_table_sort(table, false, err) : st;
}

/* --- number name R G B A ----------------------------------------------------------------- */

static bool looks_like_colors(const cwi_label_file *file)
{
    char line[CWI_LABEL_LINE_BYTES], *words[MAX_WORDS];
    memcpy(line, file->first, sizeof line);
    const size_t count = cwi_label_words(line, words, MAX_WORDS);
    return count >= COLOR_WORDS && cwi_label_is_whole(words[0]) &&
           cwi_label_is_whole(words[2]) && cwi_label_is_whole(words[3]) &&
           cwi_label_is_whole(words[4]) && (count == 5 || cwi_label_is_whole(words[5]));
}

/* Returns the sixth word of a line, and the line's end in *end; NULL if it has fewer, is a
 * comment or describes 0, the background. */
static const char *find_alpha(const char *line, const char **end)
{
    const char *s = line + strspn(line, " \t");
    *end = s + strcspn(s, "\r\n");
    if (*s == '#' || (*s == '0' && strchr(" \t", s[1])))
        return NULL;
    for (int n = 0; n < COLOR_WORDS; n++) {
        s += strcspn(s, " \t\r\n");
        s += strspn(s, " \t");
    }
    return s < *end ? s : NULL;
}

/* Tells opacities from transparencies. In both formats most labels are opaque: 255 in 3D Slicer,
 * 0 in FreeSurfer. */
static bool has_opacities(const cwi_label_file *file)
{
    size_t zeros = 0, others = 0;
    for (const char *line = file->text, *end; *line; line = end + strspn(end, "\r\n")) {
        const char *alpha = find_alpha(line, &end);
        if (alpha && *alpha == '0')
            zeros++;
        else if (alpha)
            others++;
    }
    return others > zeros;
}

static bool is_slicer(const cwi_label_file *file)
{
    return looks_like_colors(file) && (file->is_slicer || has_opacities(file));
}

/* Reads a line with the number that the file gives as A, or the one for a missing A. */
static cw_status read_color_line(char *line, size_t number, uint32_t missing, cw_label *label,
                                 uint32_t *alpha, cw_error *err)
{
    char *words[MAX_WORDS];
    const size_t count = cwi_label_words(line, words, MAX_WORDS);
    *alpha = missing;
    if (count < COLOR_WORDS)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu has %zu words; 'number name R G B A' was expected", number,
                        count);
    cw_status st = cwi_label_read_number(words[0], number, "number", label, err);
    if (st == CW_OK)
        st = cwi_label_rgb(words + 2, number, label, err);
    if (st == CW_OK && count > COLOR_WORDS)
        st = cwi_label_whole(words[COLOR_WORDS], 255, number, "A", alpha, err);
    label->name = words[1];
    return st;
}

static cw_status read_slicer_line(char *line, size_t number, cw_label *label, cw_error *err)
{
    uint32_t alpha;
    cw_status st = read_color_line(line, number, 255, label, &alpha, err);
    label->color[3] = (uint8_t)alpha;
    for (char *s = label->name; s && (s = strchr(s, '_'));)
        *s = ' ';
    return st;
}

static cw_status read_slicer(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    return read_lines(file, read_slicer_line, table, err);
}

/* Reads a line whose A is a transparency. */
static cw_status read_freesurfer_line(char *line, size_t number, cw_label *label, cw_error *err)
{
    uint32_t alpha;
    cw_status st = read_color_line(line, number, 0, label, &alpha, err);
    label->color[3] = (uint8_t)(255 - alpha);
    return st;
}

static cw_status read_freesurfer(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    return read_lines(file, read_freesurfer_line, table, err);
}

const cwi_label_format cwi_label_slicer = {"slicer", ".ctbl", is_slicer, read_slicer};
const cwi_label_format cwi_label_freesurfer = {"freesurfer", ".ctab", looks_like_colors,
                                               read_freesurfer};

/* --- number R G B A visible mesh "name" -------------------------------------------------- */

enum { ITKSNAP_WORDS = 7 };

static bool looks_like_itksnap(const cwi_label_file *file)
{
    char line[CWI_LABEL_LINE_BYTES], *words[MAX_WORDS];
    memcpy(line, file->first, sizeof line);
    char *quote = strchr(line, '"');
    if (!quote)
        return false;
    *quote = '\0';
    return cwi_label_words(line, words, MAX_WORDS) == ITKSNAP_WORDS &&
           cwi_label_is_whole(words[0]) && cwi_label_is_whole(words[1]);
}

static cw_status read_opacity(const char *word, size_t number, uint8_t *opacity, cw_error *err)
{
    const char *s = word;
    double value;
    if (!cwi_parse_double(&s, &value) || *s || !(value >= 0 && value <= 1))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu: 'A' is '%.40s'; a number from 0 to 1 was expected", number,
                        word);
    *opacity = (uint8_t)lround(255 * value);
    return CW_OK;
}

static cw_status read_itksnap_line(char *line, size_t number, cw_label *label, cw_error *err)
{
    char *words[MAX_WORDS], *quote = strchr(line, '"'), *last = strrchr(line, '"');
    uint32_t in_meshes = 1;
    if (quote == last)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: a name in double quotes was expected",
                        number);
    *quote = *last = '\0';
    const size_t count = cwi_label_words(line, words, MAX_WORDS);
    if (count != ITKSNAP_WORDS)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "line %zu has %zu words in front of the name; 'IDX R G B A VIS MSH' was "
            "expected",
            number, count);
    cw_status st = cwi_label_read_number(words[0], number, "IDX", label, err);
    if (st == CW_OK)
        st = cwi_label_rgb(words + 1, number, label, err);
    if (st == CW_OK)
        st = read_opacity(words[4], number, &label->color[3], err);
    if (st == CW_OK)
        st = cwi_label_whole(words[6], 1, number, "MSH", &in_meshes, err);
    label->hidden = !in_meshes;
    label->name = quote[1] ? quote + 1 : NULL;
    return st;
}

static cw_status read_itksnap(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    return read_lines(file, read_itksnap_line, table, err);
}

const cwi_label_format cwi_label_itksnap = {"itk-snap", ".label", looks_like_itksnap,
                                            read_itksnap};

/* --- number name [code], number;short name;full name ------------------------------------- */

static bool looks_like_names(const cwi_label_file *file)
{
    char line[CWI_LABEL_LINE_BYTES], *words[2];
    const size_t digits = strspn(file->first, "0123456789");
    const char *end = file->first + digits;
    double number;
    if (digits > 0 && *end == ';')
        return true;
    memcpy(line, file->first, sizeof line);
    const size_t count = cwi_label_words(line, words, 2);
    const char *name = count == 2 ? words[1] : "0";
    return digits > 0 && cwi_label_is_whole(words[0]) && !cwi_parse_double(&name, &number);
}

/* Ends the text at a separator. Returns the text behind it, without blanks around it, or NULL
 * if nothing follows. */
static char *cut_text(char *text, char separator)
{
    char *at = text ? strchr(text, separator) : NULL;
    if (!at)
        return NULL;
    *at++ = '\0';
    return at + strspn(at, " \t");
}

static void trim_end(char *text)
{
    size_t length = text ? strlen(text) : 0;
    while (length > 0 && strchr(" \t", text[length - 1]))
        text[--length] = '\0';
}

/* Reads a name and, with a code behind it, the code: the second of two words, or the text
 * behind a tab. Other names may have blanks. */
static void read_name(char *text, cw_label *label)
{
    char *tab = strchr(text, '\t'), *blank = tab ? tab : strchr(text, ' ');
    char *code = blank ? blank + strspn(blank, " \t") : NULL;
    label->name = text;
    if (code && (tab || cwi_label_is_whole(code)))
        *blank = '\0';
    if (code && cwi_label_is_whole(code))
        label->type.value = code;
    trim_end(text);
}

static cw_status read_name_line(char *line, size_t number, cw_label *label, cw_error *err)
{
    const char separator = line[strcspn(line, "; \t")];
    char *name = separator ? cut_text(line, separator) : NULL;
    cw_status st = cwi_label_read_number(line, number, "number", label, err);
    if (st != CW_OK)
        return st;
    if (separator == ';') {
        char *full = cut_text(name, ';');
        trim_end(name);
        label->name = full && *full ? full : name;
        label->type.value = full && *full && *name ? name : NULL;
    } else if (name) {
        read_name(name, label);
    }
    if (label->name && *label->name)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT, "line %zu: a name was expected behind %u", number,
                    label->value);
}

static cw_status read_names(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    return read_lines(file, read_name_line, table, err);
}

const cwi_label_format cwi_label_text = {"text", ".txt", looks_like_names, read_names};
