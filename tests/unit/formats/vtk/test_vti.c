/* Tests the reader of VTI: every dialect, frames, arrays, tables of blocks, and damaged
 * files. */
#include "support/files/regions.h"
#include "support/files/vtk_xml.h"

#include <stdio.h>

/* --- files put together in every dialect ------------------------------------------------- */

enum { VOXELS = 12, BYTES = 2 * VOXELS };

/* The voxels -3, -2 ... 8 (int16). */
static void add_voxels(byte_buffer *file, const dialect *d, bool text)
{
    byte_buffer plain = {.size = 0};
    for (int i = 0; i < VOXELS; i++)
        add_number(&plain, (uint64_t)(int64_t)(i - 3), 2, d->big);
    add_payload(file, d, &plain, text);
}

#define GRID                                                                                   \
    "<ImageData WholeExtent='0 1 0 2 0 1' Origin='5 6 7' Spacing='1 2 3'>"                     \
    "<Piece Extent='0 1 0 2 0 1'><PointData Scalars='s'>"
#define TAIL "</PointData></Piece></ImageData>"

static void make_file(const dialect *d, byte_buffer *file)
{
    char text[500];
    file->size = 0;
    add_file_tag(file, d, "ImageData");
    snprintf(text, sizeof text, GRID "<DataArray type='Int16' Name='s' format='%s' %s>\n ",
             form_names[d->form], d->form >= APPENDED_TEXT ? "offset='4'" : "");
    add_text(file, text);
    if (d->form == ASCII)
        add_text(file, "-3 -2 -1\n0 1 2 3 4 5 6 7 8");
    if (d->form == INLINE)
        add_voxels(file, d, true);
    add_text(file, "</DataArray>" TAIL "\n");
    if (d->form >= APPENDED_TEXT) {
        add_text(file, d->form == APPENDED_RAW ? "<AppendedData encoding='raw'>\n _<&<!"
                                               : "<AppendedData encoding='base64'>_AAAA");
        add_voxels(file, d, d->form == APPENDED_TEXT);
        add_text(file, "\n</AppendedData>");
    }
    add_text(file, "</VTKFile>");
}

/* --- tests ------------------------------------------------------------------------------- */

static void check_voxels(const char *name)
{
    const char *format = NULL;
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_read(test_path(name), NULL, &v, &format, &err), err);
    assert_string_equal(format, "vti");
    assert_int_equal(v.type, CW_I16);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){1, 0, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7});
    for (size_t i = 0; i < VOXELS; i++)
        assert_true(cw_volume_value(&v, i % 2, i / 2 % 3, i / 6) == (double)i - 3);
    cw_volume_free(&v);
}

static void every_dialect_gives_the_same_voxels(void **state)
{
    (void)state;
    static byte_buffer file;
    for (unsigned n = 0; n < 128; n++) {
        const dialect d = dialect_of(n);
        if (!is_read(&d))
            continue;
        make_file(&d, &file);
        save(&file, "a.bin");
        check_voxels("a.bin");
        check_regions("a.bin", NULL);
    }
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    static byte_buffer file;
    for (unsigned n = 0; n < 16; n++) {
        dialect d = dialect_of(n);
        d.big = n & 1;
        d.wide = n >> 1 & 1;
        if (!is_read(&d))
            continue;
        make_file(&d, &file);
        save(&file, "a.vti");
        check_every_cut("a.vti");
    }
}

/* Whatever a byte is turned into, nothing breaks; compressed voxels are right or refused. */
static void no_byte_is_trusted(void **state)
{
    (void)state;
    static byte_buffer file;
    const dialect d = {.form = APPENDED_RAW, .packing = ZLIB};
    make_file(&d, &file);
    for (size_t i = 0; i < file.size; i++) {
        cw_volume v;
        cw_error err = {0};
        const unsigned char kept = file.at[i];
        file.at[i] ^= 0x11;
        save(&file, "a.vti");
        if (read_back("a.vti", &v, &err) == CW_OK) {
            assert_true(v.data && v.components * v.dim[0] * v.dim[1] * v.dim[2] <= BYTES);
            cw_volume_free(&v);
        }
        file.at[i] = kept;
    }
}

#define FILE_TAG "<VTKFile type='ImageData' byte_order='LittleEndian'>"

static void frames_are_those_of_the_file(void **state)
{
    (void)state;
    const struct {
        const char *image, *piece;
        double affine[12];
    } cases[] = {
        {"", "0 1 0 0 0 0", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {"Origin='5 6 7' Spacing='2 3 4'", "0 1 0 0 0 0", {2, 0, 0, 5, 0, 3, 0, 6, 0, 0, 4, 7}},
        {"Origin='5 6 7' Spacing='2 3 4'",
         "10 11 -2 -2 1 1",
         {2, 0, 0, 25, 0, 3, 0, 0, 0, 0, 4, 11}},
        {"Spacing='2 3 0'", "0 1 0 0 0 0", {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0}},
        {"Origin='5 6 7' Spacing='2 3 4' Direction='0 -1 0 1 0 0 0 0 1'",
         "1 2 0 0 0 0",
         {0, -3, 0, 5, 2, 0, 0, 8, 0, 0, 4, 7}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600];
        cw_volume v;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 FILE_TAG "<ImageData %s><Piece Extent='%s'><PointData><DataArray type='UInt8' "
                          "format='ascii'>1 2</DataArray>" TAIL "</VTKFile>\n",
                 cases[i].image, cases[i].piece);
        put_file("a.vti", text, NULL, 0);
        assert_ok(read_back("a.vti", &v, &err), err);
        check_affine(&v, cases[i].affine);
        cw_volume_free(&v);
    }
}

static void the_scalars_go_before_other_arrays(void **state)
{
    (void)state;
    const struct {
        const char *attributes, *arrays;
        size_t components;
        double first;
    } cases[] = {
        {"",
         "<DataArray type='UInt8' Name='a'>1 2</DataArray>"
         "<DataArray type='UInt8' Name='b'>3 4</DataArray>",
         1, 1},
        {"Scalars='b'",
         "<DataArray type='UInt8' Name='a'>1 2</DataArray>"
         "<DataArray type='UInt8' Name='b'>3 4</DataArray>",
         1, 3},
        {"",
         "<DataArray type='UInt8' Name='v' NumberOfComponents='3'>1 2 3 4 5 6</DataArray>"
         "<DataArray type='Float64' Name='b'>3.5 4</DataArray>",
         1, 3.5},
        {"Scalars='v'",
         "<DataArray type='UInt8' Name='b'>3 4</DataArray><DataArray type='UInt8' Name='v' "
         "NumberOfComponents='2'>7 2 3 4<InformationKey "
         "name='x'>9</InformationKey></DataArray>",
         2, 7},
        {"",
         "<DataArray type='Int64' Name='l'>1 2</DataArray>"
         "<DataArray type='Int8' Name='b'>-3 4</DataArray>",
         1, -3},
        {"Scalars='l'",
         "<DataArray type='Int64' Name='l'>-1 2</DataArray>"
         "<DataArray type='Int8' Name='b'>-3 4</DataArray>",
         1, -1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[900];
        cw_volume v, one;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 FILE_TAG "<ImageData><FieldData><DataArray type='Float64' Name='t'>9"
                          "</DataArray></FieldData><Piece Extent='0 1 0 0 0 0'>"
                          "<CellData><DataArray type='UInt8'>5</DataArray></CellData>"
                          "<PointData %s>%s" TAIL "</VTKFile>\n",
                 cases[i].attributes, cases[i].arrays);
        put_file("a.vti", text, NULL, 0);
        assert_ok(read_back("a.vti", &v, &err), err);
        assert_int_equal(v.components, cases[i].components);
        assert_ok(cw_volume_select(&v, 0, 0, &one, &err), err);
        assert_true(cw_volume_value(&one, 0, 0, 0) == cases[i].first);
        cw_volume_free(&v);
    }
}

#define PIECE             FILE_TAG "<ImageData><Piece Extent='0 1 0 0 0 0'>"
#define ARRAY(attributes) PIECE "<PointData><DataArray Name='s' " attributes
#define END               TAIL "</VTKFile>"

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    const struct {
        const char *text, *words;
    } cases[] = {
        {"<VTKFile", "line 1 is not XML"},
        {"<html><VTKFile></html>", "the first element is not VTKFile"},
        {"<VTKFile type='Table'>", "the VTK file is 'Table'; only ImageData"},
        {"<VTKFile type='PTable'/>", "the VTK file is 'PTable'"},
        {"<VTKFile>", "the VTK file is ''"},
        {"<VTKFile type='ImageData' byte_order='Middle'>", "'byte_order' is 'Middle'"},
        {"<VTKFile type='ImageData' header_type='UInt16'>", "'header_type' is 'UInt16'"},
        {"<VTKFile type='ImageData' compressor='vtkLZMADataCompressor'>",
         "'compressor' is 'vtkLZMADataCompressor'; those that are read are vtkZLib"},
        {"<!DOCTYPE x [<!ENTITY a 'b'>]><VTKFile type='ImageData'/>", "a document type"},
        {"<!DOCTYPE x SYSTEM 'file:///etc/passwd'><VTKFile/>", "a document type"},
        {FILE_TAG "&a;</VTKFile>", "not XML: undefined entity"},
        {FILE_TAG "</VTKFile>", "no array that is read"},
        {FILE_TAG "<ImageData TimeValues='0 1'>", "'TimeValues' is '0 1'"},
        {FILE_TAG "<ImageData Origin='1 2'>", "'Origin' lists 2 numbers"},
        {FILE_TAG "<ImageData Spacing='1 2 x'>", "'Spacing' holds 'x'"},
        {FILE_TAG "<ImageData Direction='1 2 3'>", "'Direction' lists 3"},
        {FILE_TAG "<ImageData><Piece/>", "'Extent' is ''"},
        {FILE_TAG "<ImageData><Piece Extent='0 1 0 1 0'/>", "'Extent' is '0 1 0 1 0'"},
        {FILE_TAG "<ImageData><Piece Extent='0 1 0 1 1 0'/>", "must hold 1 to 2147483647"},
        {FILE_TAG "<ImageData><Piece Extent='0 1 0 1 -2000000000 2000000000'/>", "must hold 1"},
        {FILE_TAG "<ImageData><Piece Extent='0 1 0 1 0 99999999999'/>", "six whole numbers"},
        {FILE_TAG "<ImageData Spacing='0 1 1'><Piece Extent='0 1 0 0 0 0'><PointData>"
                  "<DataArray type='UInt8'>1 2</DataArray>" END,
         "gives axis 0 no length"},
        {FILE_TAG "<ImageData Origin='0 nan 1'><Piece Extent='0 1 0 0 0 0'><PointData>"
                  "<DataArray type='UInt8'>1 2</DataArray>" END,
         "not finite"},
        {FILE_TAG "<ImageData Direction='1 1 0 0 0 1 0 0 0'><Piece Extent='0 1 0 0 0 0'>"
                  "<PointData><DataArray type='UInt8'>1 2</DataArray>" END,
         "lie in one plane"},
        {FILE_TAG "<ImageData><Piece Extent='0 2147483646 0 2147483646 0 0'><PointData>"
                  "<DataArray type='UInt8'>1 2</DataArray>" END,
         "'Extent' asks for 4611686014132420609 bytes of voxels, encoded; the file holds"},
        {FILE_TAG "<ImageData><Piece Extent='0 2147483646 0 2147483646 0 9'><PointData>"
                  "<DataArray type='UInt8'>1 2</DataArray>" END,
         "more voxels than an address space holds"},
        {FILE_TAG "<ImageData><Piece Extent='0 15 0 0 0 0'><PointData><DataArray "
                  "type='UInt8' format='binary'>EAAAAAEC</DataArray>" END,
         "'Extent' asks for 16 bytes of voxels"},
        {PIECE "<CellData><DataArray type='UInt8'/></CellData></Piece></ImageData></VTKFile>",
         "one plane of points along y: no cells"},
        {ARRAY("type='String'>1 2</DataArray>") END,
         "no array that is read; there are 's' (1 String)"},
        {ARRAY("type='UInt8' NumberOfComponents='17'>1</DataArray>") END, "'s' (17 UInt8)"},
        {ARRAY("type='UInt8' NumberOfComponents='0'>"), "'NumberOfComponents' is '0'"},
        {ARRAY("type='UInt8' format='hex'>"),
         "'format' is 'hex'; those that are read are ascii"},
        {ARRAY("type='UInt8' format='appended'>"), "its 'offset' is missing"},
        {ARRAY("type='UInt8' format='appended' offset='-1'>"), "'offset' is '-1'"},
        {ARRAY("type='UInt8' format='appended' offset='0'/>") END, "AppendedData is missing"},
        {ARRAY("type='UInt8' format='appended' offset='0'/>") TAIL
         "<AppendedData encoding='zip'>",
         "'encoding' is 'zip'"},
        {ARRAY("type='UInt8' format='appended' offset='0'/>") TAIL "<AppendedData>x",
         "do not start with '_'"},
        {ARRAY("type='UInt8' format='appended' offset='0'/>") TAIL "<AppendedData>_AAAA",
         "does not end with </VTKFile>"},
        {ARRAY("type='UInt8' format='appended' offset='99'/>") TAIL
         "<AppendedData>_AgAAAAEC</AppendedData></VTKFile>",
         "the data end early"},
        {ARRAY("type='UInt8' format='appended' offset='9223372036854775807'/>") TAIL
         "<AppendedData encoding='raw'>_AgAAAAEC</AppendedData></VTKFile>",
         "the data end early"},
        {ARRAY("type='UInt8' format='binary'>AwAAAAEC</DataArray>") END,
         "the array 's' has 3 bytes; 'Extent' and 'type' ask for 2"},
        {ARRAY("type='UInt8' format='binary'>AgAAAAE</DataArray>") END, "the data end early"},
        {ARRAY("type='UInt8' format='binary'>AgAA*AEC</DataArray>") END, "is not base64"},
        {ARRAY("type='UInt8' format='binary'>AgAAA=EC</DataArray>") END, "is not base64"},
        {ARRAY("type='UInt8' format='binary'>AgAAAA</DataArray>") END,
         "'Extent' asks for 2 bytes"},
        {ARRAY("type='UInt8'>1</DataArray>") END, "'Extent' asks for 2 bytes"},
        {ARRAY("type='UInt8'>1  </DataArray>") END, "the voxels end after 1 numbers"},
        {ARRAY("type='UInt8'>1 300</DataArray>") END, "number 2 of the voxels is '300'"},
        {ARRAY("type='UInt8'>1 2</DataArray>") TAIL, "line 1 is not XML"},
        {"<VTKFile type='ImageData'><ImageData><Piece Extent='0 1 0 0 0 0'><PointData>"
         "<DataArray type='UInt8' format='binary'>AgAAAAEC</DataArray>" END,
         "'byte_order' is missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put_file("a.vti", cases[i].text, NULL, 0);
        check_told("a.vti", i, cases[i].words);
    }
}

/* Tables of blocks that lie, in words of 32 bits: count, size, size of the last, then each. */
static void tables_of_blocks_are_checked_before_memory_is_taken(void **state)
{
    (void)state;
    const struct {
        uint32_t words[6];
        const char *told;
    } cases[] = {
        {{0, 0, 0, 0}, "lists 0 blocks of 0 bytes"},
        {{1, 0, 0, 2}, "lists 1 blocks of 0 bytes"},
        {{1, 3, 0, 2}, "lists 1 blocks of 3 bytes, the last of 3; 2 bytes are needed"},
        {{2, 2, 0, 2, 2}, "lists 2 blocks of 2 bytes"},
        {{1, 1, 2, 2}, "lists 1 blocks of 1 bytes, the last of 2"},
        {{0xffffffff, 0xffffffff, 0xffffffff, 9}, "lists 4294967295 blocks"},
        {{2, 1, 0, 9, 0xffffffff}, "compressed block 1 of 2 has 4294967295 bytes; the file"},
        {{2, 1, 0, 0, 9}, "block 0 of 2 has 1 bytes, compressed 0"},
        {{1, 2, 2, 4}, "compressed block 0 of 1 is damaged"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        byte_buffer file = {.size = 0};
        add_text(&file, "<VTKFile type='ImageData' byte_order='LittleEndian' "
                        "compressor='vtkZLibDataCompressor'><ImageData><Piece "
                        "Extent='0 1 0 0 0 0'><PointData><DataArray type='UInt8' "
                        "format='appended' offset='0'/>" TAIL "<AppendedData encoding='raw'>_");
        for (int w = 0; w < 6; w++)
            add_number(&file, cases[i].words[w], 4, false);
        add_text(&file, "</AppendedData></VTKFile>");
        save(&file, "a.vti");
        check_told("a.vti", i, cases[i].told);
    }
}

/* A limit of its own for each thing that a file could have without end. */
static void endless_files_come_to_an_end(void **state)
{
    (void)state;
    enum { SIZE = 3 << 20 };
    char *text = malloc(SIZE + 1);
    assert_non_null(text);
    memset(text, 'x', SIZE);
    memcpy(text, "<VTKFile a='", 12);
    put_file("a.vti", "", text, SIZE);
    check_told("a.vti", 0, "a tag longer than 1 MiB");
    for (size_t i = 0; i < SIZE; i += 4)
        memcpy(text + i, "<a/>", 4);
    put_file("a.vti", FILE_TAG, text, SIZE);
    check_told("a.vti", 1, "more than 100000 elements");
    for (size_t i = 0; i + 3 <= SIZE; i += 3)
        memcpy(text + i, "<a>", 3);
    put_file("a.vti", FILE_TAG, text, SIZE / 3 * 3);
    check_told("a.vti", 2, "more than 64 elements inside each other");
    free(text);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static byte_buffer file;
    for (form f = ASCII; f < FORM_COUNT; f++) {
        const dialect d = {.form = f, .packing = ZLIB};
        make_file(&d, &file);
        save(&file, "a.vti");
        check_starved_reads("a.vti");
        check_starved("a.vti", &(cw_read_desc){.region = &(cw_box){{1, 1, 0}, {1, 1, 2}}});
    }
}

/* The last of the four blocks holds what is wanted of the back alone. */
static void blocks_that_are_not_wanted_are_not_decoded(void **state)
{
    (void)state;
    static byte_buffer file;
    static const char tail[] = "\n</AppendedData></VTKFile>";
    const cw_box front = {{0, 0, 0}, {2, 3, 1}}, back = {{1, 2, 1}, {1, 1, 1}};
    for (int wanted = 0; wanted < 2; wanted++) {
        const cw_read_desc desc = {.region = wanted ? &back : &front};
        cw_volume v;
        cw_error err = {0};
        make_file(&(dialect){.form = APPENDED_RAW, .packing = ZLIB}, &file);
        file.at[file.size - sizeof tail] ^= 1; /* in a checksum */
        save(&file, "a.vti");
        const cw_status st = cw_volume_read(test_path("a.vti"), &desc, &v, NULL, &err);
        if (wanted)
            assert_fails(st, CW_ERR_FORMAT, "compressed block 3 of 4 is damaged", err);
        else
            assert_ok(st, err);
        cw_volume_free(&v);
    }
}

static void without_lz4_its_files_are_refused(void **state)
{
    (void)state;
    put_file("a.vti", "<VTKFile type='ImageData' compressor='vtkLZ4DataCompressor'/>", NULL, 0);
    check_told("a.vti", 0, cwi_lz4_present() ? "no array" : "this build has no LZ4");
}

/* --- several pieces ----------------------------------------------------------------------- */

/* A piece of a volume whose voxel i, j, k is i + 10 j + 100 k. of_cells: the same of cells */
static void add_piece(byte_buffer *file, const int extent[6], bool of_cells, const char *type)
{
    char text[200];
    const char *kind = of_cells ? "CellData" : "PointData";
    snprintf(text, sizeof text,
             "<Piece Extent='%d %d %d %d %d %d'><%s Scalars='s'><DataArray type='%s' Name='s' "
             "format='ascii'>",
             extent[0], extent[1], extent[2], extent[3], extent[4], extent[5], kind, type);
    add_text(file, text);
    for (int k = extent[4]; k <= extent[5] - of_cells; k++)
        for (int j = extent[2]; j <= extent[3] - of_cells; j++)
            for (int i = extent[0]; i <= extent[1] - of_cells; i++) {
                snprintf(text, sizeof text, " %d", i + 10 * j + 100 * k);
                add_text(file, text);
            }
    snprintf(text, sizeof text, "</DataArray></%s></Piece>", kind);
    add_text(file, text);
}

#define WHOLE                                                                                  \
    "<VTKFile type='ImageData'><ImageData WholeExtent='0 4 0 3 0 2' Origin='5 6 7' "           \
    "Spacing='1 2 3'>"

static void save_pieces(const char *name, const int (*extents)[6], size_t count, bool of_cells)
{
    byte_buffer file = {.size = 0};
    add_text(&file, WHOLE);
    for (size_t n = 0; n < count; n++)
        add_piece(&file, extents[n], of_cells, "Int16");
    add_text(&file, "</ImageData></VTKFile>");
    test_file_write(test_path(name), file.at, file.size);
}

static void check_joined(const char *name, bool of_cells)
{
    cw_volume v;
    cw_error err = {0};
    const double shift = of_cells ? 0.5 : 0;
    assert_ok(read_back(name, &v, &err), err);
    assert_true(v.dim[0] == 5u - of_cells && v.dim[1] == 4u - of_cells &&
                v.dim[2] == 3u - of_cells);
    assert_place(&v, 0, 0, 0, 5 + shift, 6 + 2 * shift, 7 + 3 * shift);
    for (size_t k = 0; k < v.dim[2]; k++)
        for (size_t j = 0; j < v.dim[1]; j++)
            for (size_t i = 0; i < v.dim[0]; i++)
                assert_true(cw_volume_value(&v, i, j, k) == (double)(i + 10 * j + 100 * k));
    cw_volume_free(&v);
    const cw_box box = {.first = {1, 1, 0}, .count = {3, 2, 2}};
    const cw_read_desc part = {.region = &box, .every = {2, 1, 1}};
    assert_ok(cw_volume_read(test_path(name), &part, &v, NULL, &err), err);
    assert_true(v.dim[0] == 2 && v.dim[1] == 2 && v.dim[2] == 2);
    assert_true(cw_volume_value(&v, 1, 1, 1) == 3 + 20 + 100);
    assert_place(&v, 0, 0, 0, 6 + shift, 8 + 2 * shift, 7 + 3 * shift);
    cw_volume_free(&v);
    const cw_read_desc head = {.header_only = true, .region = &box, .every = {2, 1, 1}};
    assert_ok(cw_volume_read(test_path(name), &head, &v, NULL, &err), err);
    assert_true(v.dim[0] == 2 && v.dim[1] == 2 && !v.data);
    cw_volume_free(&v);
    const cw_read_desc few = {.max_voxels = 3};
    assert_int_equal(cw_volume_read(test_path(name), &few, &v, NULL, &err), CW_ERR_LIMIT);
}

static const int halves[2][6] = {{0, 2, 0, 3, 0, 2}, {2, 4, 0, 3, 0, 2}};
static const int mixed[4][6] = {
    {0, 4, 0, 3, 2, 2}, {3, 4, 0, 3, 0, 1}, {0, 3, 0, 1, 0, 1}, {0, 3, 1, 3, 0, 1}};

static void pieces_are_joined_wherever_they_lie(void **state)
{
    (void)state;
    save_pieces("a.vti", halves, 2, false);
    check_joined("a.vti", false);
    save_pieces("b.vti", halves, 2, true);
    check_joined("b.vti", true);
    save_pieces("c.vti", mixed, 4, false);
    check_joined("c.vti", false);
}

static void a_list_joins_its_files(void **state)
{
    (void)state;
    static const char list[] =
        "<VTKFile type='PImageData'><PImageData WholeExtent='0 4 0 3 0 2' GhostLevel='0' "
        "Origin='5 6 7' Spacing='1 2 3'><PPointData Scalars='s'/>"
        "<Piece Extent='0 2 0 3 0 2' Source='p0.vti'/><Piece Extent='2 4 0 3 0 2' "
        "Source='p1.vti'/></PImageData></VTKFile>";
    cw_volume v;
    cw_error err = {0};
    for (int n = 0; n < 2; n++)
        save_pieces(n ? "p1.vti" : "p0.vti", halves + n, 1, false);
    put_file("a.pvti", list, NULL, 0);
    check_joined("a.pvti", false);
    assert_ok(read_back("p1.vti", &v, &err), err); /* a piece by itself */
    assert_place(&v, 0, 0, 0, 7, 6, 7);
    cw_volume_free(&v);
    assert_int_equal(remove(test_path("p1.vti")), 0);
    assert_fails(read_back("a.pvti", &v, &err), CW_ERR_IO, "p1.vti", err);
}

static void pieces_that_do_not_fit_are_told(void **state)
{
    (void)state;
    static const int gap[2][6] = {{0, 2, 0, 3, 0, 2}, {3, 4, 0, 3, 0, 1}};
    static const int beyond[2][6] = {{0, 2, 0, 3, 0, 2}, {2, 5, 0, 3, 0, 2}};
    cw_volume v;
    cw_error err = {0};
    save_pieces("a.vti", gap, 2, false);
    assert_fails(read_back("a.vti", &v, &err), CW_ERR_FORMAT, "no Piece has the voxel 3, 0, 2",
                 err);
    save_pieces("a.vti", beyond, 2, false);
    assert_fails(read_back("a.vti", &v, &err), CW_ERR_FORMAT, "leaves the 'WholeExtent'", err);
    byte_buffer file = {.size = 0};
    add_text(&file, WHOLE);
    add_piece(&file, halves[0], false, "Int16");
    add_piece(&file, halves[1], false, "Float32");
    add_text(&file, "</ImageData></VTKFile>");
    test_file_write(test_path("a.vti"), file.at, file.size);
    assert_fails(read_back("a.vti", &v, &err), CW_ERR_FORMAT, "pieces differ", err);
    static const struct {
        const char *text, *words;
    } lists[] = {
        {"<VTKFile type='PImageData'><PImageData WholeExtent='0 1 0 1 0 1'><Piece Extent='0 1 0 1 "
         "0 1'/></PImageData></VTKFile>",
         "a Piece has no 'Source'"},
        {"<VTKFile type='PImageData'><PImageData><Piece Source='a.vti'/></PImageData></VTKFile>",
         "'WholeExtent' does not state"},
        {"<VTKFile type='PImageData'><PImageData WholeExtent='0 1 0 1 0 1'/></VTKFile>",
         "it has no Piece element"},
        {"<VTKFile type='PImageData'><PImageData WholeExtent='0 1 0 1 0 1'><Piece "
         "Source='../a.vti'/></PImageData></VTKFile>",
         "a path with '..'"},
        {"<VTKFile type='PRectilinearGrid'/>", "'WholeExtent' does not state"},
        {"<VTKFile type='vtkHierarchicalBoxDataSet'/>", "a list of other files"},
    };
    for (size_t n = 0; n < sizeof lists / sizeof *lists; n++) {
        put_file("l.pvti", lists[n].text, NULL, 0);
        const cw_status st = read_back("l.pvti", &v, &err);
        if (st == CW_OK || !strstr(err.message, lists[n].words))
            fail_msg("%s: %s", lists[n].text, st == CW_OK ? "it was read" : err.message);
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(pieces_are_joined_wherever_they_lie),
        TEST(a_list_joins_its_files),
        TEST(pieces_that_do_not_fit_are_told),
        TEST(every_dialect_gives_the_same_voxels),
        TEST(a_cut_is_never_a_volume),
        TEST(no_byte_is_trusted),
        TEST(frames_are_those_of_the_file),
        TEST(the_scalars_go_before_other_arrays),
        TEST(damaged_files_are_told_where),
        TEST(tables_of_blocks_are_checked_before_memory_is_taken),
        TEST(endless_files_come_to_an_end),
        TEST(blocks_that_are_not_wanted_are_not_decoded),
        TEST(memory_may_run_out_anywhere),
        TEST(without_lz4_its_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
