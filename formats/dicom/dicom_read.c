/* Reads a DICOM series as a volume, and lists the series of a folder. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/dicom/dicom_format.h"
#include "formats/dicom/dicom_overlap.h"
#include "formats/dicom/dicom_segments.h"
#include "formats/dicom/dicom_stack.h"
#include "formats/volume/voxel_source.h"

#include <stdio.h>
#include <string.h>

static cw_status open_library(cwi_planes *planes, const cw_read_desc *desc, cw_error *err)
{
    return cwi_planes_open(planes, "dicom", "DCMTK", desc, err);
}

/* Reads the facts of the one file that was named. */
static cw_status facts_of_file(const cwi_input *in, cwi_planes *planes, cwi_dicom_facts *f,
                               cw_error *err)
{
    const void *shared;
    cw_status st = cwi_dicom_facts_of(planes, in->fd, in->size, &shared, err);
    if (st != CW_OK)
        return st;
    memcpy(f, shared, sizeof *f);
    f->series[sizeof f->series - 1] = f->refusal[sizeof f->refusal - 1] = '\0';
    if (f->refusal[0])
        return cwi_fail(err, CW_ERR_FORMAT, "%s", f->refusal);
    if (f->kind == CWI_DICOM_NO_IMAGE)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "DICOM without an image; to read a series, name its folder");
    return CW_OK;
}

/* Scans all files of a folder, or those beside one file that are of its series. */
static cw_status scan_files(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                            cwi_planes *planes, cwi_dicom_scan *found, cw_error *err)
{
    cwi_dicom_facts facts;
    cwi_names beside = {0};
    if (names)
        return cwi_dicom_scan_files(found, in, names, NULL, desc, planes, err);
    cw_status st = facts_of_file(in, planes, &facts, err);
    if (st == CW_OK)
        st = cwi_files_beside(in, &beside, &found->links, err);
    if (st == CW_OK)
        st = cwi_dicom_scan_files(found, in, &beside, &facts, desc, planes, err);
    cwi_names_free(&beside);
    return st;
}

/* Notes the findings. In a folder all files count; beside a named file only probable members
 * do. */
static void note_scan(const cw_read_desc *desc, const cwi_dicom_scan *found, bool folder)
{
    cwi_note_links(desc, found->links);
    cwi_damaged_note(&found->damaged, "left out, because they cannot be read", desc);
    if (folder && found->strangers)
        cwi_note(desc, "left out, because they are not DICOM images: %zu of its files",
                 found->strangers);
    if (folder && found->copies)
        cwi_note(desc, "left out, because they are copies of others: %zu images",
                 found->copies);
}

/* Refuses one image of a series whose other files are elsewhere. */
static cw_status expect_series(const cw_volume *shape, cw_error *err)
{
    if (shape->dim[2] * shape->steps > 1)
        return CW_OK;
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "one image of a DICOM series: the others are missing, and data without a "
                    "path have no files beside them; files of many frames are read");
}

/* Parts segments that overlap into layers, and adds their names to the table that is wanted. */
static cw_status read_segments(const cwi_dicom_scan *found, size_t series, const cwi_input *in,
                               cwi_planes *planes, const cw_read_desc *desc, cwi_stack *stack,
                               cw_error *err)
{
    const cwi_dicom_facts *f = found->series[series].sample->file;
    if (f->kind == CWI_DICOM_FRACTIONS)
        cwi_note(desc, "its segments are fractions from 0 to 1, a component each: their "
                       "surfaces are at 0.5");
    if (f->kind == CWI_DICOM_IMAGE || f->kind == CWI_DICOM_FRACTIONS)
        return CW_OK;
    uint8_t *layer_of = cwi_alloc_zeroed(CWI_DICOM_SEGMENTS, 1);
    cw_status st = layer_of ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && f->kind == CWI_DICOM_SEGMENTATION && !f->never_overlaps)
        st = cwi_dicom_find_layers(stack, in, planes, desc, layer_of, err);
    if (st == CW_OK && stack->shape.components > 1)
        cwi_note(desc, "segments overlap: they are in %zu layers, a component each",
                 stack->shape.components);
    if (st == CW_OK && desc->labels)
        st = cwi_dicom_add_segments(found, series, layer_of, desc->labels, err);
    cwi_free(layer_of);
    return st;
}

cw_status cwi_dicom_read(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                         cw_volume *volume, cw_error *err)
{
    cwi_planes planes = {0};
    cwi_dicom_scan found = {0};
    cwi_dicom_findings findings;
    cwi_stack stack = {0};
    size_t series = 0;
    cw_status st = open_library(&planes, desc, err);
    if (st == CW_OK)
        st = scan_files(in, names, desc, &planes, &found, err);
    if (st == CW_OK)
        st = cwi_dicom_choose(&found, desc->series, &series, err);
    if (st == CW_OK && !desc->skip_damaged)
        st = cwi_dicom_expect_whole(&found, series, desc->series || !names, err);
    if (st == CW_OK)
        note_scan(desc, &found, names != NULL);
    if (st == CW_OK)
        st = cwi_dicom_stack(&found, series, desc, &stack, &findings, err);
    if (st == CW_OK && cwi_input_is_stored(in))
        st = expect_series(&stack.shape, err);
    if (st == CW_OK)
        st = cwi_check_frame(&stack.shape, "ImagePositionPatient", err);
    if (st == CW_OK) {
        cwi_set_spacing(&stack.shape, desc);
        stack.files = found.files; /* borrowed */
        st = read_segments(&found, series, in, &planes, desc, &stack, err);
        if (st == CW_OK)
            st = cwi_stack_load(&stack, in, &planes, desc, volume, err);
        stack.files = (cwi_names){0};
    }
    cwi_stack_free(&stack);
    cwi_dicom_scan_free(&found);
    cwi_planes_close(&planes);
    return st;
}

/* --- the list ----------------------------------------------------------------------------- */

static void describe_series(cwi_dicom_scan *found, size_t n, bool chosen,
                            const cw_read_desc *desc, cw_series *s)
{
    cwi_stack stack = {0};
    cwi_dicom_findings findings = {0};
    cw_error err = {0};
    cw_read_desc quiet = *desc;
    quiet.note = NULL;
    const cwi_dicom_series *from = &found->series[n];
    snprintf(s->label, sizeof s->label, "%s", from->label);
    snprintf(s->modality, sizeof s->modality, "%s", from->sample->file->modality);
    s->images = from->count;
    s->status = desc->skip_damaged ? CW_OK : cwi_dicom_expect_whole(found, n, chosen, &err);
    if (s->status == CW_OK)
        s->status = cwi_dicom_stack(found, n, &quiet, &stack, &findings, &err);
    if (s->status == CW_OK)
        cwi_set_spacing(&stack.shape, desc);
    s->shape = stack.shape;
    s->tilt_degrees = findings.tilt_degrees;
    snprintf(s->finding, sizeof s->finding, "%s",
             s->status == CW_OK ? findings.gaps : err.message);
    if (s->status != CW_OK) { /* the facts that are known anyway */
        s->shape.type = from->sample->file->type;
        s->shape.dim[0] = from->sample->file->columns;
        s->shape.dim[1] = from->sample->file->rows;
        s->shape.dim[2] = from->count;
    }
    cwi_stack_free(&stack);
}

static cw_status list_found(cwi_dicom_scan *found, bool named, const cw_read_desc *desc,
                            cw_series **series, size_t *count, cw_error *err)
{
    const bool chosen = named || desc->series || found->series_count > 1;
    cw_series *all = cwi_alloc_zeroed(found->series_count, sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < found->series_count; n++)
        describe_series(found, n, chosen, desc, &all[n]);
    cwi_damaged_note(&found->damaged, "cannot be read", desc);
    *series = all;
    *count = found->series_count;
    return CW_OK;
}

cw_status cwi_dicom_list(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                         cw_series **series, size_t *count, cw_error *err)
{
    cwi_planes planes = {0};
    cwi_dicom_scan found = {0};
    cw_status st = open_library(&planes, desc, err);
    if (st == CW_OK)
        st = scan_files(in, names, desc, &planes, &found, err);
    if (st == CW_OK)
        st = list_found(&found, !names, desc, series, count, err);
    cwi_dicom_scan_free(&found);
    cwi_planes_close(&planes);
    return st;
}

void cw_series_free(cw_series *series)
{
    cwi_free(series);
}
