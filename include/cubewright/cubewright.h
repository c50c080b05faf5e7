/* Includes every public header of the library. */
#ifndef CUBEWRIGHT_CUBEWRIGHT_H
#define CUBEWRIGHT_CUBEWRIGHT_H

#include <cubewright/appearance.h>
#include <cubewright/atlas.h>
#include <cubewright/bake.h>
#include <cubewright/boolean.h>
#include <cubewright/camera.h>
#include <cubewright/check.h>
#include <cubewright/color.h>
#include <cubewright/core.h>
#include <cubewright/cut.h>
#include <cubewright/distance.h>
#include <cubewright/engrave.h>
#include <cubewright/extract.h>
#include <cubewright/field.h>
#include <cubewright/filter.h>
#include <cubewright/formats.h>
#include <cubewright/handles.h>
#include <cubewright/hard.h>
#include <cubewright/label_table.h>
#include <cubewright/labels.h>
#include <cubewright/level_set.h>
#include <cubewright/mesh.h>
#include <cubewright/overlay.h>
#include <cubewright/picture.h>
#include <cubewright/pieces.h>
#include <cubewright/pipeline.h>
#include <cubewright/print.h>
#include <cubewright/quality.h>
#include <cubewright/remesh.h>
#include <cubewright/render.h>
#include <cubewright/repair.h>
#include <cubewright/simplify.h>
#include <cubewright/slice_filter.h>
#include <cubewright/smooth.h>
#include <cubewright/spool.h>
#include <cubewright/stored_file.h>
#include <cubewright/stream.h>
#include <cubewright/team.h>
#include <cubewright/transfer.h>
#include <cubewright/volume.h>
#include <cubewright/voxelize.h>

#endif
