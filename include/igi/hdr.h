/* SPDX-License-Identifier: Apache-2.0
 *
 * From brackets of exposures to radiance.
 */
#ifndef IGI_HDR_H
#define IGI_HDR_H

#include <igi/image.h>
#include <igi/photo.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One photograph of a bracket. What it gathers of a radiance L is proportional to L h, with the
 * exposure h = time_s (iso/100) / f_number^2; an f-number or ISO of 0 is not known and counts as
 * 1 and 100, which all photographs of a set must then share. */
typedef struct igi_exposure {
    char *path;
    double time_s, f_number, iso;
    bool from_camera; /* EXIF: the camera's own word, not somebody's list */
} igi_exposure;

/* Reads a list: a line an image, `NAME SECONDS [F-NUMBER [ISO]]`, seconds also as 1/60; from `#`
 * on it is a comment. Names are relative to the list. */
IGI_API IGI_MUST_USE igi_status igi_exposures_read(igi_context *context, const char *list_path,
                                                   igi_exposure **exposures, size_t *count);
/* The exposures that EXIF states. */
IGI_API IGI_MUST_USE igi_status igi_exposures_probe(igi_context *context, const char *const *paths,
                                                    size_t count, igi_exposure **exposures);
IGI_API void igi_exposures_destroy(igi_exposure *exposures, size_t count);

/* What a camera makes of light: exposure[channels][levels] is the relative exposure that gives
 * each code, rising, 1 at the highest code. Codes below low[c] or above high[c] tell little: the
 * curve is extrapolated there. */
typedef struct igi_response {
    int channels, levels; /* as igi_photo's */
    float *exposure;
    int low[3], high[3];
    double deviation; /* standard deviation of exposures against each other, relative, as far as the
                       * photographs of one bracket contradict each other; 0: given, not recovered */
} igi_response;

IGI_API IGI_MUST_USE igi_status igi_response_create(igi_context *context, int channels, int levels,
                                                    igi_response **response);
IGI_API void igi_response_destroy(igi_response *response);

typedef enum igi_response_kind {
    IGI_RESPONSE_AUTO, /* linear for raw and 16-bit photographs, else recovered */
    IGI_RESPONSE_LINEAR,
    IGI_RESPONSE_SRGB,       /* the standard's curve (IEC 61966-2-1) */
    IGI_RESPONSE_GIVEN,      /* igi_merge_options.given */
    IGI_RESPONSE_RECOVERED,  /* from all pixels of the bracket */
    IGI_RESPONSE_POLYNOMIAL, /* likewise, as a polynomial (Mitsunaga and Nayar 1999) */
    IGI_RESPONSE_EMOR,    /* likewise, from the space of known responses (Grossberg and Nayar 2003);
                        * its table is igi_merge_options.basis_path */
    IGI_RESPONSE_DEBEVEC, /* Debevec and Malik 1997, OpenCV's */
    IGI_RESPONSE_ROBERTSON /* Robertson, Borman and Stevenson 2003, OpenCV's */
} igi_response_kind;

typedef enum igi_merge_method {
    IGI_MERGE_PHOTON,   /* weights by the noise of photons, read-out and quantisation */
    IGI_MERGE_DEBEVEC,  /* for comparison, OpenCV's: 8-bit colour, no variance */
    IGI_MERGE_ROBERTSON /* likewise */
} igi_merge_method;

typedef struct igi_merge_options {
    size_t struct_size;
    igi_response_kind response; /* default IGI_RESPONSE_AUTO */
    const igi_response *given;
    const char *basis_path;  /* the EMoR model's invemor.txt; igi does not carry it */
    igi_merge_method method; /* default IGI_MERGE_PHOTON */
    bool align;         /* find and undo shifts and turns between exposures; default. Photographs
                              * that lie on each other by a tenth of a pixel are not resampled */
    bool refine;        /* exposure ratios from the pictures where the response is known;
                                  * default. Else they are only held against what is stated */
    double full_well_e; /* photo-electrons at the highest code; 0: 5000, and the variance
                                  * is scaled to the scatter between the exposures */
    double read_noise;  /* standard deviation in codes; 0: 2.5 of 256, or 12 of 65536 */
} igi_merge_options;

IGI_API void igi_merge_options_init(igi_merge_options *options);

typedef struct igi_merged_frame {
    double stated, used;     /* exposure h; `stated` of what was given, `used` after refining */
    double shift_x, shift_y; /* pixels: its content stands that much further right and down than in
                              * the shortest exposure */
    double rotation_deg;     /* and turned so much about the picture's centre, from right to down */
    double saturated;        /* fraction of its samples */
    double moved; /* fraction of its pixels that show another thing than longer exposures;
                           * they are left out */
} igi_merged_frame;

typedef struct igi_merged {
    igi_image *image; /* R G B (or Y): radiance, full scale / h; "saturated": 1 where even the
                       * shortest exposure was, .5 where something moved between exposures; "variance.B" ..: of the colour of that name */
    igi_response *response;
    size_t count;
    igi_merged_frame *frames; /* in the order given */
    double scatter;           /* measured standard deviation / that of the noise model */
    char *warning;            /* what is odd about the photographs; NULL: nothing */
} igi_merged;

/* Merges a bracket. The photographs are read one at a time. When the pictures contradict listed
 * exposures, IGI_E_DATA with the names of the frames. When they contradict the camera's own word,
 * its processing differed from frame to frame (phones do that): `warning` says so, and EXIF stands;
 * unless two frames are simply equal. */
IGI_API IGI_MUST_USE igi_status igi_merge(igi_context *context, const igi_exposure *exposures,
                                          size_t count, const igi_merge_options *options,
                                          igi_merged **merged);
IGI_API void igi_merged_destroy(igi_merged *merged);

#ifdef __cplusplus
}
#endif
#endif
