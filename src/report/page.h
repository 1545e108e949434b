/* SPDX-License-Identifier: Apache-2.0
 *
 * The page's parts share this.
 */
#ifndef IGI_SRC_REPORT_PAGE_H
#define IGI_SRC_REPORT_PAGE_H

#include "report/colour.h"

#include <igi/material.h>

#include <jansson.h>
#include <stdio.h>

typedef struct igi_page {
    igi_context *ctx;
    const char *folder; /* of the result */
    FILE *file;
    const igi_materials *materials;
    const igi_materials *truth; /* or NULL */
    json_t *evidence;           /* evidence.json; NULL when there is none */
    json_t *manifest;           /* NULL when there is none */
    json_t *comparisons;        /* index.json; NULL likewise */
    json_t *relight;            /* relight/index.json; NULL likewise */
    igi_srgb srgb;
} igi_page;

/* Head and header; script and foot. */
void igi_page_begin(const igi_page *page, const char *name, const char *lead);
void igi_page_end(const igi_page *page);
/* What `print` puts into page->file becomes the file `path`, whole or not at all. */
typedef igi_status (*igi_page_fn)(const igi_page *page, const void *user);
IGI_MUST_USE igi_status igi_page_write(igi_page *page, const char *path, igi_page_fn print,
                                       const void *user);

/* The style sheet and the script, line by line, ended by NULL. */
extern const char *const igi_page_style[];
extern const char *const igi_page_script[];

/* Text with HTML's characters escaped. */
void igi_page_text(const igi_page *page, const char *text);
/* An <img> with the pixels inside; `label` is its alternative text. */
IGI_MUST_USE igi_status igi_page_pixels(const igi_page *page, const uint8_t *pixels, int width,
                                        int height, int channels, const char *label);
/* The same of a PNG file. */
IGI_MUST_USE igi_status igi_page_png_file(const igi_page *page, const char *path,
                                          const char *label);
/* "0.031 %" or so. */
void igi_page_percent(const igi_page *page, double fraction);
/* Largest sigma/albedo over the bands. */
double igi_material_share(const igi_material *material, int bands);

/* Has the region a map to show? */
bool igi_page_has_map(const igi_material *material);
/* One photograph and its albedo, two figures. */
IGI_MUST_USE igi_status igi_page_first_view(const igi_page *page);

/* Sections; page.c knows which of them have something to say. */
IGI_MUST_USE igi_status igi_page_table(const igi_page *page);
IGI_MUST_USE igi_status igi_page_spheres(const igi_page *page);
IGI_MUST_USE igi_status igi_page_evidence(const igi_page *page);
IGI_MUST_USE igi_status igi_page_lights(const igi_page *page);
IGI_MUST_USE igi_status igi_page_maps(const igi_page *page);
IGI_MUST_USE igi_status igi_page_views(const igi_page *page);
IGI_MUST_USE igi_status igi_page_relight(const igi_page *page);
IGI_MUST_USE igi_status igi_page_costs(const igi_page *page);
IGI_MUST_USE igi_status igi_page_provenance(const igi_page *page);

#endif
