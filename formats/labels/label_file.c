/* Opens files of labels, finds their format, and parses their lines. */
#include "formats/labels/label_file.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/bytes/input_file.h"
#include "formats/text/label_xml.h"

#include <ctype.h>
#include <jansson.h>
#include <string.h>

enum {
    MAX_BYTES = 64 << 20,
    MAX_JSON_BYTES = 16 << 20,
    JSON_FACTOR = 32 /* bytes of memory that are counted for a byte of JSON */
};

/* --- XML --------------------------------------------------------------------------------- */

static bool is_label_xml(const cwi_label_file *file)
{
    return cwi_label_xml_sniff(file->text);
}

static cw_status read_label_xml(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    return cwi_label_xml_read(file->text, file->size, table, err);
}

const cwi_label_format cwi_label_xml = {"workbench", NULL, is_label_xml, read_label_xml};

/* Formats in the order in which content is tested. */
static const cwi_label_format *const formats[] = {
    &cwi_label_xml,        &cwi_label_niivue, &cwi_label_ome_zarr, &cwi_label_nnunet,
    &cwi_label_csv,        &cwi_label_bids,   &cwi_label_itksnap,  &cwi_label_slicer,
    &cwi_label_freesurfer, &cwi_label_text,
};
enum { FORMAT_COUNT = sizeof formats / sizeof *formats };

/* --- content ----------------------------------------------------------------------------- */

static cw_status check_zero_bytes(const cwi_label_file *file, cw_error *err)
{
    const char *zero = memchr(file->text, '\0', file->size);
    size_t line = 1;
    if (!zero)
        return CW_OK;
    for (const char *s = file->text; s < zero; s++)
        line += *s == '\n';
    return cwi_fail(err, CW_ERR_FORMAT, "line %zu holds a zero byte; text was expected", line);
}

static cw_status read_text(cwi_label_file *file, int fd, uint64_t size, cw_error *err)
{
    static const char mark[] = "\xef\xbb\xbf";
    size_t got;
    if (size > MAX_BYTES)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the file has %llu bytes; a table of labels has 64 MiB at most",
                        (unsigned long long)size);
    file->bytes = cwi_alloc_array((size_t)size + 1, 1);
    if (!file->bytes)
        return cwi_fail_memory(err);
    cw_status st = cwi_input_read_at(fd, 0, file->bytes, (size_t)size, &got, err);
    if (st != CW_OK)
        return st;
    file->bytes[got] = '\0';
    const size_t skipped = got >= 3 && memcmp(file->bytes, mark, 3) == 0 ? 3 : 0;
    file->text = file->bytes + skipped;
    file->size = got - skipped;
    return check_zero_bytes(file, err);
}

static cw_status parse_json(cwi_label_file *file, cw_error *err)
{
    json_error_t why;
    if (file->size > MAX_JSON_BYTES)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the file has %zu bytes of JSON; a table of labels has 16 MiB at most",
                        file->size);
    if (!cwi_memory_take(JSON_FACTOR * file->size))
        return cwi_fail_memory(err);
    file->json = json_loadb(file->text, file->size, 0, &why);
    if (!file->json)
        cwi_memory_give(JSON_FACTOR * file->size);
    if (file->json)
        return CW_OK;
    return json_error_code(&why) == json_error_out_of_memory
               ? cwi_fail_memory(err)
               : cwi_fail(err, CW_ERR_FORMAT, "line %d, column %d: %s", why.line, why.column,
                          why.text);
}

/* Looks at the comments in front of the first line, and copies that. */
static cw_status find_first_line(cwi_label_file *file, cw_error *err)
{
    const char *s = file->text;
    for (;;) {
        s += strspn(s, " \t\r\n");
        if (*s != '#')
            break;
        const size_t length = strcspn(s, "\r\n");
        char comment[64] = "";
        memcpy(comment, s, length < sizeof comment ? length : sizeof comment - 1);
        if (strstr(comment, "olor procedural file"))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "a procedural colour file gives colours to a scale; a table of "
                            "labels was expected");
        file->is_slicer |= strstr(comment, "olor table file") || strstr(comment, "Slicer3");
        s += length;
    }
    const size_t length = strcspn(s, "\r\n");
    memcpy(file->first, s, length < CWI_LABEL_LINE_BYTES ? length : CWI_LABEL_LINE_BYTES - 1);
    return CW_OK;
}

cw_status cwi_label_file_open(cwi_label_file *file, int fd, uint64_t size, cw_error *err)
{
    *file = (cwi_label_file){0};
    cw_status st = read_text(file, fd, size, err);
    if (st != CW_OK)
        return st;
    const char first = file->text[strspn(file->text, " \t\r\n")];
    return first == '{'   ? parse_json(file, err)
           : first == '<' ? CW_OK
                          : find_first_line(file, err);
}

void cwi_label_file_close(cwi_label_file *file)
{
    if (file->json)
        cwi_memory_give(JSON_FACTOR * file->size);
    json_decref(file->json);
    cwi_free(file->bytes);
    *file = (cwi_label_file){0};
}

/* --- formats ----------------------------------------------------------------------------- */

const cwi_label_format *cwi_label_format_of(const cwi_label_file *file)
{
    for (size_t n = 0; n < FORMAT_COUNT; n++)
        if (formats[n]->recognise(file))
            return formats[n];
    return NULL;
}

/* Finds a format for lines that look like none, so that its reader names what is wrong. */
static const cwi_label_format *find_by_extension(const char *path, const cwi_label_file *file)
{
    for (size_t n = 0; file->first[0] && n < FORMAT_COUNT; n++)
        if (formats[n]->extensions && cwi_has_extension(path, formats[n]->extensions))
            return formats[n];
    return NULL;
}

static cw_status read_table(const cwi_input *in, cw_label_table *table, const char **format,
                            cw_error *err)
{
    cwi_label_file file;
    cw_status st = cwi_label_file_open(&file, in->fd, in->size, err);
    const cwi_label_format *f = st == CW_OK ? cwi_label_format_of(&file) : NULL;
    if (st == CW_OK && !f)
        f = find_by_extension(in->path, &file);
    if (f)
        st = f->read(&file, table, err);
    else if (st == CW_OK)
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "not a label table; those of FreeSurfer, ITK-SNAP, 3D Slicer, "
                      "BIDS, niivue, Connectome Workbench and OME-Zarr are read, and lines of "
                      "'number name'");
    if (st == CW_OK && format)
        *format = f->name;
    cwi_label_file_close(&file);
    return st;
}

cw_status cw_label_table_read(const char *path, cw_label_table *table, const char **format,
                              cw_error *err)
{
    CWI_REQUIRE(err, path, table);
    cwi_input in = {0};
    cw_label_table_free(table);
    if (format)
        *format = NULL;
    cw_status st = cwi_input_open(&in, path, err);
    if (st == CW_OK)
        st = read_table(&in, table, format, err);
    cwi_input_close(&in);
    if (st == CW_OK)
        return CW_OK;
    cw_label_table_free(table);
    return cwi_fail_in(err, st, path);
}

/* --- lines ------------------------------------------------------------------------------- */

char *cwi_label_line(cwi_label_lines *lines)
{
    while (*lines->next) {
        char *line = lines->next, *end = line + strcspn(line, "\r\n");
        lines->next = end + (*end != '\0') + (end[0] == '\r' && end[1] == '\n');
        lines->number++;
        while (end > line && isspace((unsigned char)end[-1]))
            end--;
        *end = '\0';
        line += strspn(line, " ");
        if (*line && *line != '#')
            return line;
    }
    return NULL;
}

size_t cwi_label_words(char *line, char **words, size_t capacity)
{
    size_t count = 0;
    for (char *s = line + strspn(line, " \t"); *s && count < capacity; count++) {
        words[count] = s;
        s += strcspn(s, " \t");
        if (*s)
            *s++ = '\0';
        s += strspn(s, " \t");
    }
    return count;
}

bool cwi_label_is_whole(const char *word)
{
    return *word && !word[strspn(word, "0123456789")];
}

cw_status cwi_label_whole(const char *word, uint32_t max, size_t line, const char *field,
                          uint32_t *value, cw_error *err)
{
    uint64_t number = 0;
    const char *s = word;
    for (; *s >= '0' && *s <= '9' && number <= max; s++)
        number = 10 * number + (uint64_t)(*s - '0');
    if (s == word || *s || number > max)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu: '%s' is '%.40s'; a whole number from 0 to %u was expected",
                        line, field, word, max);
    *value = (uint32_t)number;
    return CW_OK;
}

cw_status cwi_label_read_number(const char *word, size_t line, const char *field,
                                cw_label *label, cw_error *err)
{
    return cw_label_parse(word, label)
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT,
                          "line %zu: '%s' is '%.40s'; a whole number of up to 64 bits was "
                          "expected",
                          line, field, word);
}

cw_status cwi_label_rgb(char *const words[3], size_t line, cw_label *label, cw_error *err)
{
    static const char *const names[] = {"R", "G", "B"};
    cw_status st = CW_OK;
    for (int c = 0; c < 3 && st == CW_OK; c++) {
        uint32_t value = 0;
        st = cwi_label_whole(words[c], 255, line, names[c], &value, err);
        label->color[c] = (uint8_t)value;
    }
    label->color[3] = 255;
    label->has_color = true;
    return st;
}
