/* Lists the format drivers, in the order of `formats`, and finds them by name or extension. */
#include "formats/format_registry.h"

#include "core/base/features.h"
#include "formats/3mf/3mf_format.h"
#include "formats/dicom/dicom_format.h"
#include "formats/draco/drc_format.h"
#include "formats/freesurfer/freesurfer_format.h"
#include "formats/gifti/gifti_format.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/inr/inr_format.h"
#include "formats/metaimage/metaimage_format.h"
#include "formats/mgh/mgh_format.h"
#include "formats/mrc/mrc_format.h"
#include "formats/n5/n5_format.h"
#include "formats/neuroglancer/neuroglancer_format.h"
#include "formats/nifti/nifti_format.h"
#include "formats/npy/npy_format.h"
#include "formats/nrrd/nrrd_format.h"
#include "formats/obj/obj_format.h"
#include "formats/off/off_format.h"
#include "formats/picture/picture_format.h"
#include "formats/plot3d/plot3d_format.h"
#include "formats/ply/ply_format.h"
#include "formats/precomputed/precomputed_format.h"
#include "formats/raw/raw_format.h"
#include "formats/stl/stl_format.h"
#include "formats/tiff/tiff_format.h"
#include "formats/vdb/vdb_format.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtkhdf/vtkhdf_format.h"
#include "formats/zarr/zarr_format.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

static const cwi_format_driver *const drivers[] = {
    &cwi_format_nrrd,   &cwi_format_nifti,        &cwi_format_metaimage,
    &cwi_format_vtk,    &cwi_format_vtu,          &cwi_format_vtm,
    &cwi_format_vti,    &cwi_format_vtkhdf,       &cwi_format_mrc,
    &cwi_format_inr,    &cwi_format_mgh,          &cwi_format_npy,
    &cwi_format_npz,    &cwi_format_dicom,        &cwi_format_tiff,
    &cwi_format_png,    &cwi_format_bmp,          &cwi_format_zarr,
    &cwi_format_n5,     &cwi_format_precomputed,  &cwi_format_vdb,
    &cwi_format_plot3d, &cwi_format_raw,          &cwi_format_glb,
    &cwi_format_gltf,   &cwi_format_stl,          &cwi_format_ply,
    &cwi_format_obj,    &cwi_format_off,          &cwi_format_3mf,
    &cwi_format_vtp,    &cwi_format_gifti,        &cwi_format_freesurfer,
    &cwi_format_drc,    &cwi_format_neuroglancer,
};
enum { DRIVER_COUNT = sizeof drivers / sizeof *drivers };

static cw_format formats[DRIVER_COUNT];
static pthread_once_t formats_once = PTHREAD_ONCE_INIT;

const cwi_format_driver *cwi_format_at(size_t n)
{
    return n < DRIVER_COUNT ? drivers[n] : NULL;
}

const cwi_format_driver *cwi_find_format(const char *name)
{
    for (size_t n = 0; n < DRIVER_COUNT; n++)
        if (strcmp(drivers[n]->name, name) == 0)
            return drivers[n];
    return NULL;
}

bool cwi_reads_volume(const cwi_format_driver *f)
{
    const cwi_volume_reading *v = &f->volume;
    return v->parse || v->read_grid || v->read_file || v->read_slices;
}

const char *cwi_volume_extensions(const cwi_format_driver *f)
{
    return f->volume.extensions ? f->volume.extensions : f->extensions;
}

const char *cwi_list_formats(const char *(*text_of)(const cwi_format_driver *),
                             const char *separator, char list[CWI_FORMAT_LIST])
{
    size_t used = 0;
    list[0] = '\0';
    for (size_t n = 0; n < DRIVER_COUNT && used < CWI_FORMAT_LIST; n++) {
        const char *text = text_of(drivers[n]);
        if (text)
            used += (size_t)snprintf(list + used, CWI_FORMAT_LIST - used, "%s%s",
                                     used ? separator : "", text);
    }
    return list;
}

/* Fills the list once, at run time: a module may have been left out of a package. */
static void fill_formats(void)
{
    for (size_t n = 0; n < DRIVER_COUNT; n++) {
        const cwi_format_driver *f = drivers[n];
        const cw_feature *feature = f->feature ? cwi_find_feature(f->feature) : NULL;
        formats[n] = (cw_format){
            .name = f->name,
            .extensions = f->extensions,
            .about = f->about,
            .reads_volume = cwi_reads_volume(f) || f == &cwi_format_raw,
            .writes_volume = f->save.save,
            .reads_mesh = f->mesh.read,
            .writes_mesh = f->write.write,
            .in_this_build = !f->feature || (feature && feature->available),
            .reason = !f->feature ? ""
                      : feature   ? feature->reason
                                  : "no such feature",
            .lost = f->lost ? f->lost : "",
            .keeps = f->keeps,
        };
    }
}

const cw_format *cw_formats(size_t *count)
{
    pthread_once(&formats_once, fill_formats);
    *count = DRIVER_COUNT;
    return formats;
}
