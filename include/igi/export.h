/* SPDX-License-Identifier: Apache-2.0
 *
 * A recovered scene in the words of other programs.
 */
#ifndef IGI_EXPORT_H
#define IGI_EXPORT_H

#include <igi/material.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the scene's mesh with these materials and lights as binary glTF 2.0: one primitive a
 * region, base colour maps inside, roughness = sqrt(alpha), KHR_materials_specular for rho_s,
 * KHR_materials_emissive_strength for lamps, KHR_lights_punctual for point, spot and directional
 * lights. A textured region whose mesh has no texture coordinates gets those of its map. Of more
 * than three bands the first three are taken for R, G and B. */
IGI_API IGI_MUST_USE igi_status igi_materials_save_glb(igi_context *context,
                                                       const igi_materials *materials,
                                                       const igi_scene *scene, const char *path);

typedef enum igi_export_format {
    IGI_EXPORT_GLB,     /* binary glTF 2.0, as above */
    IGI_EXPORT_OBJ,     /* Wavefront OBJ, with an MTL and PNG textures */
    IGI_EXPORT_MITSUBA, /* Mitsuba 3, XML */
    IGI_EXPORT_PBRT,    /* pbrt-v4 */
    IGI_EXPORT_RADIANCE /* Radiance scene description */
} igi_export_format;

IGI_API const char *igi_export_format_name(igi_export_format format);
IGI_API bool igi_export_format_from_name(const char *name, igi_export_format *format);

typedef struct igi_export_options {
    size_t struct_size;
    igi_export_format format; /* default IGI_EXPORT_GLB */
    const char *lights;       /* a file of the lights that are on; NULL: the result's own */
    const char *cameras;      /* a cameras' file; NULL: those that the result was recovered from,
                               * where they still lie where manifest.json says */
    const char *command;      /* the command line, for the manifest; may be NULL */
} igi_export_options;

IGI_API void igi_export_options_init(igi_export_options *options);

/* Writes what `folder` holds (the result of a recovery, or a scene's truth) to the file `path`; all
 * but glTF also write a folder beside it, `path`_files, that holds meshes and textures and is
 * replaced as igi_output_begin has it. What a format cannot say is
 * put into its nearest words, with a warning. */
IGI_API IGI_MUST_USE igi_status igi_export(igi_context *context, const char *folder,
                                           const igi_export_options *options, const char *path);

#ifdef __cplusplus
}
#endif
#endif
