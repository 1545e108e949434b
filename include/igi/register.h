/* SPDX-License-Identifier: Apache-2.0
 *
 * Registration: cameras moved until the edges of the photographs lie on those of the mesh.
 */
#ifndef IGI_REGISTER_H
#define IGI_REGISTER_H

#include <igi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A point known in two frames of reference: the cameras' and the mesh's. */
typedef struct igi_point_pair {
    double from[3], to[3];
} igi_point_pair;

/* Reads `X Y Z  X Y Z` a line; from `#` on it is a comment. *pairs is the caller's, to be freed with
 * igi_point_pairs_destroy. */
IGI_API IGI_MUST_USE igi_status igi_point_pairs_read(igi_context *context, const char *path,
                                                     igi_point_pair **pairs, size_t *count);
IGI_API void igi_point_pairs_destroy(igi_point_pair *pairs);

/* to = scale * rotation * from + offset */
typedef struct igi_similarity {
    double scale, rotation[3][3], offset[3];
} igi_similarity;

/* The similarity that brings the pairs together in the least-squares sense (Horn 1987). *rms_m: what
 * is left, metres of the mesh. IGI_E_NO_ANSWER: fewer than three pairs, or all on one line. */
IGI_API IGI_MUST_USE igi_status igi_similarity_fit(igi_context *context,
                                                   const igi_point_pair *pairs, size_t count,
                                                   igi_similarity *similarity, double *rms_m);
/* Moves the cameras of a scene from the one frame of reference to the other. */
IGI_API void igi_scene_move_cameras(igi_scene *scene, const igi_similarity *similarity);

typedef struct igi_register_options {
    size_t struct_size;
    double search_px; /* how far edges may lie off at the start; default 4 */
    bool together;    /* first one similarity for all cameras: they share an error */
    bool compare;     /* default true: say how the photographs agree then, which reads them again */
} igi_register_options;

IGI_API void igi_register_options_init(igi_register_options *options);

typedef struct igi_registered_frame {
    char *image;
    size_t edges;               /* places at which it was measured in the end */
    double before_px, after_px; /* robust root mean square of the edges' distances */
    double moved_px;            /* typical shift of its image that the refinement made */
    double sigma_px;         /* of the image's place, one standard deviation, from the residuals */
    double gain, gain_sigma; /* brightness against the other photographs' */
    bool moved; /* false: too few edges, or not clearly better; it stays where it was */
    bool
        unsettled; /* it may be off still: its edges are few or lie farther off than the others' where
                       most cameras were moved, or it still moved in the last round */
} igi_registered_frame;

typedef struct igi_registered {
    size_t frame_count;
    igi_registered_frame *frames;
    double before_px, after_px; /* root mean square over the frames */
    /* How the photographs then agree about places that several show: the standard deviation
     * of ln gain over the frames, and the typical share of places at which one contradicts. */
    double gain_spread, contradicts;
    igi_similarity together; /* of all cameras, as asked for or as `world` says; or identity */
    bool world; /* all cameras were off alike against the mesh, by a turn, a move or a scale */
    bool mesh_is_off; /* edges of different things contradict each other: cameras stayed */
    bool lens; /* all pictures shared a shift or were all too large, and cameras were mended: */
    struct {
        double shift_px[2], magnification; /* added to the principal point; of the focal length */
    } shared;
} igi_registered;

/* Refines the poses of the scene's cameras in place. Edges are where regions, depth or normals
 * change; shadows that look like edges are outvoted. IGI_E_NO_ANSWER when no frame shows enough
 * edges. */
IGI_API IGI_MUST_USE igi_status igi_register(igi_context *context, igi_scene *scene,
                                             const igi_register_options *options,
                                             igi_registered **registered);
IGI_API void igi_registered_destroy(igi_registered *registered);

#ifdef __cplusplus
}
#endif
#endif
