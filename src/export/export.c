/* SPDX-License-Identifier: Apache-2.0
 *
 * What is exported, where to, and how: one way for all formats.
 */
#include "export/export_private.h"
#include "base/file.h"
#include "material/result.h"

#include <igi/output.h>

#include <string.h>
#include <unistd.h>

typedef struct format {
    const char *name;
    igi_status (*write)(const igi_exporter *e); /* NULL: glTF, which is one file */
} format;

static const format formats[] = {
    [IGI_EXPORT_GLB] = {"glb", NULL},
    [IGI_EXPORT_OBJ] = {"obj", igi_write_obj},
    [IGI_EXPORT_MITSUBA] = {"mitsuba", igi_write_mitsuba},
    [IGI_EXPORT_PBRT] = {"pbrt", igi_write_pbrt},
    [IGI_EXPORT_RADIANCE] = {"radiance", igi_write_radiance},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

const char *igi_export_format_name(igi_export_format f)
{
    return (size_t)f < FORMATS ? formats[f].name : "unknown";
}

bool igi_export_format_from_name(const char *name, igi_export_format *f)
{
    for (size_t i = 0; i < FORMATS; i++)
        if (strcmp(name, formats[i].name) == 0) {
            *f = (igi_export_format)i;
            return true;
        }
    return false;
}

void igi_export_options_init(igi_export_options *options)
{
    *options = (igi_export_options){.struct_size = sizeof *options, .format = IGI_EXPORT_GLB};
}

/* The main file lies in the folder until both are moved to their places. */
static igi_status write_files(igi_exporter *e, const format *f, const char *part)
{
    igi_file file;
    IGI_TRY(igi_file_begin(e->ctx, part, &file));
    e->file = file.stream;
    igi_status status = f->write(e);
    e->file = NULL;
    return igi_file_end(e->ctx, &file, status);
}

static igi_status move(igi_context *ctx, const char *from, const char *to)
{
    if (rename(from, to) == 0) return IGI_OK;
    return igi_fail_writing(ctx, to);
}

/* path "a/room.xml": folder "a/room.xml_files", which the file calls "room.xml_files". */
static igi_status name_folder(igi_context *ctx, const char *path, char **folder, char **files)
{
    IGI_TRY(igi_strprintf(ctx, folder, "%s_files", path));
    return igi_strprintf(ctx, files, "%s_files", igi_file_name(path));
}

static igi_status write_with_folder(igi_exporter *e, const format *f, const char *input,
                                    const igi_export_options *options, const char *path)
{
    igi_status status = IGI_OK;
    char *folder = NULL, *files = NULL, *part = NULL;
    igi_output *output = NULL;
    const char *inputs[2];
    igi_manifest manifest = {.command = options->command ? options->command : "", .inputs = inputs};
    if (options->lights) inputs[manifest.input_count++] = options->lights;
    if (options->cameras) inputs[manifest.input_count++] = options->cameras;
    IGI_TRY_GOTO(name_folder(e->ctx, path, &folder, &files));
    IGI_TRY_GOTO(igi_output_begin(e->ctx, folder, false, input, &output));
    e->folder = igi_output_folder(output);
    e->files = files;
    IGI_TRY_GOTO(igi_strprintf(e->ctx, &part, "%s.file", e->folder));
    IGI_TRY_GOTO(write_files(e, f, part));
    IGI_TRY_GOTO(igi_manifest_save(e->ctx, &manifest, e->folder));
    IGI_TRY_GOTO(igi_output_commit(e->ctx, output));
    IGI_TRY_GOTO(move(e->ctx, part, path));
cleanup:
    if (status != IGI_OK && part) unlink(part);
    igi_output_destroy(output);
    igi_free(folder);
    igi_free(files);
    igi_free(part);
    return status;
}

static igi_status write_glb(igi_exporter *e, const char *path)
{
    char *part = NULL;
    IGI_TRY(igi_strprintf(e->ctx, &part, "%s.%ld.part", path, (long)getpid()));
    igi_status status = igi_materials_save_glb(e->ctx, e->materials, e->scene, part);
    if (status == IGI_OK) status = move(e->ctx, part, path);
    if (status != IGI_OK) unlink(part);
    igi_free(part);
    return status;
}

igi_status igi_export(igi_context *ctx, const char *folder, const igi_export_options *options,
                      const char *path)
{
    igi_status status = IGI_OK;
    igi_scene *scene = NULL;
    igi_materials *materials = NULL;
    igi_light *lights = NULL;
    igi_frame *frames = NULL;
    char *found = NULL;
    size_t light_count = 0, frame_count = 0;
    const format *f = &formats[options->format];
    igi_stage_begin(ctx, "export");
    IGI_TRY_GOTO(igi_result_load(ctx, folder, &scene, &materials));
    igi_materials lit = *materials; /* borrows all but perhaps the lights */
    if (options->lights) {
        IGI_TRY_GOTO(igi_lights_load(ctx, scene, options->lights, &lights, &light_count));
        lit.lights = lights;
        lit.light_count = light_count;
    }
    bool shows = f->write && options->format != IGI_EXPORT_OBJ; /* it knows cameras */
    if (shows && !options->cameras) IGI_TRY_GOTO(igi_result_cameras(ctx, folder, &found));
    if (shows && !options->cameras && !found)
        igi_warn(ctx, "no cameras are exported: give their file with --cameras");
    for (size_t i = 0, lost = 0; i < lit.light_count && options->format != IGI_EXPORT_RADIANCE; i++)
        if (lit.lights[i].profile > 0 && lost++ == 0)
            igi_warn(ctx,
                     "%s knows no lamps with a profile: they shine with their mean radiance in all "
                     "directions",
                     f->name);
    const char *cameras = options->cameras ? options->cameras : found;
    if (cameras) IGI_TRY_GOTO(igi_frames_load(ctx, cameras, &frames, &frame_count));
    igi_exporter e = {.ctx = ctx,
                      .scene = scene,
                      .materials = &lit,
                      .frames = frames,
                      .frame_count = frame_count};
    status = f->write ? write_with_folder(&e, f, folder, options, path) : write_glb(&e, path);
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_frames_destroy(frames, frame_count);
    igi_lights_destroy(lights, light_count);
    igi_materials_destroy(materials);
    igi_scene_destroy(scene);
    igi_free(found);
    return status;
}
