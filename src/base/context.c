/* SPDX-License-Identifier: Apache-2.0 */
#include "base/context.h"
#include "base/context_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

const char *igi_status_meaning(igi_status status)
{
    switch (status) {
#define IGI_STATUS_CASE(name, value, meaning) \
    case name: return meaning;
        IGI_STATUS_LIST(IGI_STATUS_CASE)
#undef IGI_STATUS_CASE
    }
    return "an unknown status";
}

void igi_context_options_init(igi_context_options *options)
{
    *options = (igi_context_options){.struct_size = sizeof *options, .seed = 1};
}

static int processor_count(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n < 1 ? 1 : n > IGI_MAX_THREADS ? IGI_MAX_THREADS : (int)n;
}

igi_status igi_context_create(const igi_context_options *options, igi_context **context)
{
    *context = NULL;
    igi_context_options o;
    igi_context_options_init(&o);
    if (options) o = *options;
    if (o.struct_size != sizeof o || o.threads < 0 || o.threads > IGI_MAX_THREADS)
        return IGI_E_USAGE;
    igi_context *ctx = calloc(1, sizeof *ctx);
    if (!ctx) return IGI_E_SYSTEM;
    ctx->options = o;
    if (ctx->options.threads == 0) ctx->options.threads = processor_count();
    ctx->root = ctx;
    atomic_init(&ctx->cancelled, false);
    atomic_init(&ctx->rays, 0);
    atomic_init(&ctx->allocations_left, -1);
    *context = ctx;
    return IGI_OK;
}

void igi_context_destroy(igi_context *context)
{
    free(context);
}

const char *igi_context_message(const igi_context *context)
{
    return context->message;
}

void igi_context_cancel(igi_context *context)
{
    atomic_store(&context->root->cancelled, true);
}

igi_status igi_fail(igi_context *ctx, igi_status status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(ctx->message, sizeof ctx->message, format, args);
    va_end(args);
    return status;
}

void igi_warn(igi_context *ctx, const char *format, ...)
{
    if (!ctx->options.log) return;
    char sentence[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    ctx->options.log(ctx->options.user, sentence);
}

int igi_threads(const igi_context *ctx)
{
    return ctx->options.threads;
}

uint64_t igi_seed(const igi_context *ctx)
{
    return ctx->options.seed;
}

double igi_cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double wall_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void stage_end(igi_context *ctx)
{
    if (!ctx->stage_open) return;
    igi_stage *stage = &ctx->stages[ctx->stage_count - 1];
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    stage->cpu_s = igi_cpu_seconds() - ctx->stage_cpu0;
    stage->wall_s = wall_seconds() - ctx->stage_wall0;
    stage->rays = atomic_load(&ctx->rays) - ctx->stage_rays0;
    stage->peak_bytes = (uint64_t)usage.ru_maxrss * 1024;
    ctx->stage_open = false;
}

void igi_stage_begin(igi_context *ctx, const char *name)
{
    stage_end(ctx);
    if (!name || ctx->stage_count == IGI_MAX_STAGES) return;
    ctx->stages[ctx->stage_count++] = (igi_stage){.name = name};
    ctx->stage_cpu0 = igi_cpu_seconds();
    ctx->stage_wall0 = wall_seconds();
    ctx->stage_rays0 = atomic_load(&ctx->rays);
    ctx->stage_open = true;
    ctx->last_report_s = 0;                   /* a new stage is reported at once */
    igi_status status = igi_progress(ctx, 0); /* a wish to stop is heard at the next report */
    (void)status;
}

size_t igi_context_stages(const igi_context *context, const igi_stage **stages)
{
    *stages = context->stages;
    return context->stage_count;
}

igi_status igi_progress(igi_context *ctx, double fraction)
{
    igi_context *root = ctx->root;
    if (ctx == root && root->options.progress && root->stage_open) {
        double now = wall_seconds();
        if (now - root->last_report_s >= 0.1 || fraction >= 1) {
            root->last_report_s = now;
            const char *name = root->stages[root->stage_count - 1].name;
            if (!root->options.progress(root->options.user, name, fraction))
                igi_context_cancel(root);
        }
    }
    if (atomic_load_explicit(&root->cancelled, memory_order_relaxed))
        return igi_fail(ctx, IGI_E_CANCELLED, "interrupted; nothing was written");
    return IGI_OK;
}

void igi_count_rays(igi_context *ctx, uint64_t rays)
{
    atomic_fetch_add_explicit(&ctx->root->rays, rays, memory_order_relaxed);
}
