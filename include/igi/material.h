/* SPDX-License-Identifier: Apache-2.0
 *
 * Materials: what igi recovers, renders with and compares. A folder of them is what
 * `igi recover` writes (materials.json, albedo/, uncertainty/).
 */
#ifndef IGI_MATERIAL_H
#define IGI_MATERIAL_H

#include <igi/image.h>
#include <igi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* theta from the normal, delta from the normal to the half vector, alpha the roughness:
 * lambert  f = rho_d/pi
 * ward     f = rho_d/pi + rho_s exp(-tan^2 delta/alpha^2) / (4 pi alpha^2 sqrt(cos_i cos_o))
 * ggx      f = rho_d/pi + F D G2 / (4 cos_i cos_o), Trowbridge-Reitz D of width alpha,
 *          height-correlated Smith G2, Schlick F with F0 = rho_s
 * phong    f = rho_d/pi + rho_s (n+2)/(2 pi) cos^n(r.o), n = 2/alpha^2 - 2 */
typedef enum igi_model { IGI_LAMBERT, IGI_WARD, IGI_GGX, IGI_PHONG } igi_model;

IGI_API const char *igi_model_name(igi_model model);
/* false when there is no such model. */
IGI_API bool igi_model_from_name(const char *name, igi_model *model);

typedef struct igi_material {
    char *region; /* the region's name */
    bool emitter;
    igi_model model;
    double albedo[IGI_MAX_BANDS]; /* rho_d; area mean over what the photos determine */
    double albedo_std[IGI_MAX_BANDS];
    bool determined;      /* false: no photograph shows it; albedo is then a guess, as std says */
    double specular;      /* rho_s; 0 for lambert */
    double specular_std;  /* of lambert: what may have been overlooked, 1.645 of it is the bound */
    bool specular_is_rgb; /* coloured: specular_rgb holds; else all its bands equal specular */
    double specular_rgb[IGI_MAX_BANDS], specular_rgb_std[IGI_MAX_BANDS];
    double alpha, alpha_std; /* roughness; 0 for lambert */
    double observed;         /* fraction of the region's area that a photograph determines */
    int views;               /* photographs that see it */
    bool textured;           /* evidence asks for a map, not for one albedo */
    igi_image *map;     /* rho_d per band, then A: 0..1, how far photos determine it; or NULL */
    igi_image *map_std; /* one standard deviation per band; NULL with map */
    size_t warning_count;
    char **warnings;
} igi_material;

typedef struct igi_materials {
    char *scene; /* its name */
    int bands;
    size_t count; /* one for each region of the scene, in its order */
    igi_material *materials;
    size_t light_count; /* as in the scene, with what was solved filled in */
    igi_light *lights;
    double (*light_std)[IGI_MAX_BANDS]; /* [light_count] of each value; 0 where it was given */
    size_t warning_count;
    char **warnings;
} igi_materials;

/* Writes materials.json, albedo/ and uncertainty/ into an existing folder. Same content, same
 * bytes: no times, no paths. `scene` names the regions of area lights. */
IGI_API IGI_MUST_USE igi_status igi_materials_save(igi_context *context,
                                                   const igi_materials *materials,
                                                   const igi_scene *scene, const char *folder);

/* Reads what igi_materials_save wrote, or a truth folder (truth.json with "texture" maps).
 * An area light's region is its index among the materials, -1 where there is none of its name.
 * `determined` is observed > 0, `textured` is that materials.json names a map. */
IGI_API IGI_MUST_USE igi_status igi_materials_load(igi_context *context, const char *folder,
                                                   igi_materials **materials);
IGI_API void igi_materials_destroy(igi_materials *materials);

#ifdef __cplusplus
}
#endif
#endif
