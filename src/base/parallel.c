/* SPDX-License-Identifier: Apache-2.0
 *
 * Workers take tasks in rising order from one counter. A failure at index i stops the handing out;
 * every lower index has been taken by then, so the lowest failing index, and with it the sentence
 * that the user reads, does not depend on timing.
 */
#include "base/parallel.h"
#include "base/context_private.h"

#include <pthread.h>
#include <string.h>

typedef struct loop {
    igi_context *root;
    igi_task_fn task;
    void *user;
    size_t count;
    atomic_size_t next;
    atomic_size_t done;
    atomic_bool stop;
} loop;

typedef struct worker {
    loop *loop;
    igi_context ctx;
    int number;
    pthread_t thread;
    bool started;
    igi_status status;
    size_t failed_at;
} worker;

static void work(worker *w)
{
    loop *l = w->loop;
    while (!atomic_load_explicit(&l->stop, memory_order_relaxed)) {
        size_t index = atomic_fetch_add(&l->next, 1);
        if (index >= l->count) return;
        w->status = l->task(&w->ctx, l->user, index, w->number);
        size_t done = atomic_fetch_add(&l->done, 1) + 1;
        /* Only the calling thread speaks to the user. */
        igi_context *speaker = w->number == 0 ? l->root : &w->ctx;
        if (w->status == IGI_OK) {
            w->status = igi_progress(speaker, (double)done / (double)l->count);
            if (w->status != IGI_OK)
                memcpy(w->ctx.message, speaker->message, sizeof w->ctx.message);
        }
        if (w->status != IGI_OK) {
            w->failed_at = index;
            atomic_store(&l->stop, true);
            return;
        }
    }
}

static void *thread_main(void *argument)
{
    work(argument);
    return NULL;
}

static void worker_init(worker *w, loop *l, int number, bool alone)
{
    w->loop = l;
    w->number = number;
    w->ctx.options = l->root->options;
    w->ctx.root = l->root->root;
    if (!alone) w->ctx.options.threads = 1; /* a loop within a task runs on the task's thread */
}

igi_status igi_parallel_for(igi_context *ctx, size_t count, igi_task_fn task, void *user)
{
    if (count == 0) return IGI_OK;
    size_t threads = (size_t)ctx->options.threads < count ? (size_t)ctx->options.threads : count;
    worker *workers;
    IGI_TRY(IGI_ALLOC(ctx, threads, &workers));
    loop l = {.root = ctx, .task = task, .user = user, .count = count};
    for (size_t i = 0; i < threads; i++) worker_init(&workers[i], &l, (int)i, threads == 1);
    for (size_t i = 1; i < threads; i++) /* a thread that cannot be had only costs time */
        workers[i].started = pthread_create(&workers[i].thread, NULL, thread_main, &workers[i]) ==
                             0;
    work(&workers[0]);
    const worker *first = NULL;
    for (size_t i = 0; i < threads; i++) {
        if (workers[i].started) pthread_join(workers[i].thread, NULL);
        if (workers[i].status == IGI_OK) continue;
        if (!first || workers[i].failed_at < first->failed_at) first = &workers[i];
    }
    igi_status status = IGI_OK;
    if (first) {
        status = first->status;
        memcpy(ctx->message, first->ctx.message, sizeof ctx->message);
    }
    igi_free(workers);
    return status;
}
