// Runtime API: streams, events, graphs.

#include "cuda_on_cpu/machine/call.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_api.h"

using namespace cuda_on_cpu;

namespace {

/// Calls f(stream) if the handle names a stream.
template <class F>
cudaError_t with_stream(cudaStream_t handle, F f) {
    return call([&] {
        CUstream_st* stream = stream_of(handle);
        return stream ? f(*stream) : cudaErrorInvalidResourceHandle;
    });
}

template <class F>
cudaError_t with_event(cudaEvent_t event, F f) {
    return call([&] { return is_event(event) ? f(*event) : cudaErrorInvalidResourceHandle; });
}

/// Fails and invalidates the capture if the stream captures: nobody can wait for such a stream.
cudaError_t refuse_capture(CUstream_st& stream) {
    if (!stream.capture) return cudaSuccess;
    stream.capture->invalid = true;
    return cudaErrorStreamCaptureUnsupported;
}

}  // namespace

cudaError_t cudaStreamCreateWithPriority(cudaStream_t* stream, unsigned flags, int priority) {
    return call([&] {
        if (!stream || flags > cudaStreamNonBlocking) return cudaErrorInvalidValue;
        *stream = create_stream(flags != cudaStreamNonBlocking, priority, host_thread().device);
        return cudaSuccess;
    });
}
cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned flags) {
    return cudaStreamCreateWithPriority(stream, flags, 0);
}
cudaError_t cudaStreamCreate(cudaStream_t* stream) { return cudaStreamCreateWithFlags(stream, cudaStreamDefault); }

cudaError_t cudaStreamDestroy(cudaStream_t handle) {
    return with_stream(handle, [&](CUstream_st& stream) {
        if (&stream != handle) return cudaErrorInvalidResourceHandle;
        destroy_stream(&stream);
        return cudaSuccess;
    });
}
cudaError_t cudaStreamSynchronize(cudaStream_t handle) {
    return with_stream(handle, [](CUstream_st& stream) {
        if (const cudaError_t error = refuse_capture(stream)) return error;
        if (const cudaError_t error = leave_capture_alone()) return error;
        drain(&stream);
        return cudaSuccess;
    });
}
cudaError_t cudaStreamQuery(cudaStream_t handle) {
    return with_stream(handle, [](CUstream_st& stream) {
        if (const cudaError_t error = refuse_capture(stream)) return error;
        if (const cudaError_t error = leave_capture_alone()) return error;
        if (stream.queue.empty()) return cudaSuccess;
        step(&stream);
        return cudaErrorNotReady;
    });
}
cudaError_t cudaStreamGetFlags(cudaStream_t handle, unsigned* flags) {
    return with_stream(handle, [&](CUstream_st& stream) {
        if (!flags) return cudaErrorInvalidValue;
        *flags = stream.blocking ? cudaStreamDefault : cudaStreamNonBlocking;
        return cudaSuccess;
    });
}
cudaError_t cudaStreamGetPriority(cudaStream_t handle, int* priority) {
    return with_stream(handle, [&](CUstream_st& stream) {
        if (!priority) return cudaErrorInvalidValue;
        *priority = stream.priority;
        return cudaSuccess;
    });
}
cudaError_t cudaStreamGetDevice(cudaStream_t handle, int* device) {
    return with_stream(handle, [&](CUstream_st& stream) {
        if (!device) return cudaErrorInvalidValue;
        *device = stream.device;
        return cudaSuccess;
    });
}
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t handle, unsigned) {
    return with_event(handle, [&](CUevent_st& event) { return wait_for(stream, &event); });
}
cudaError_t cudaLaunchHostFunc(cudaStream_t stream, cudaHostFn_t function, void* data) {
    return call([&] {
        if (!function) return cudaErrorInvalidValue;
        return enqueue(stream, {Work::Kind::host, nullptr, [=] { function(data); }});
    });
}

cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned flags) {
    return call([&] {
        if (!event) return cudaErrorInvalidValue;
        *event = create_event(flags);
        return cudaSuccess;
    });
}
cudaError_t cudaEventCreate(cudaEvent_t* event) { return cudaEventCreateWithFlags(event, cudaEventDefault); }
cudaError_t cudaEventDestroy(cudaEvent_t handle) {
    return with_event(handle, [](CUevent_st& event) {
        destroy_event(&event);
        return cudaSuccess;
    });
}
cudaError_t cudaEventRecord(cudaEvent_t handle, cudaStream_t stream) {
    return with_event(handle, [&](CUevent_st& event) { return record(&event, stream); });
}
cudaError_t cudaEventSynchronize(cudaEvent_t handle) {
    return with_event(handle, [](CUevent_st& event) {
        if (event.captured) return cudaErrorCapturedEvent;
        if (const cudaError_t error = leave_capture_alone()) return error;
        if (!reached(&event)) drain(event.marker->stream, event.marker->number);
        return cudaSuccess;
    });
}
cudaError_t cudaEventQuery(cudaEvent_t handle) {
    return with_event(handle, [](CUevent_st& event) {
        if (event.captured) return cudaErrorCapturedEvent;
        if (const cudaError_t error = leave_capture_alone()) return error;
        if (reached(&event)) return cudaSuccess;
        step(event.marker->stream);
        return cudaErrorNotReady;
    });
}
cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t begin, cudaEvent_t end) {
    return call([&] {
        if (!milliseconds) return cudaErrorInvalidValue;
        for (const cudaEvent_t event : {begin, end}) {
            if (!is_event(event) || event->flags & cudaEventDisableTiming) return cudaErrorInvalidResourceHandle;
            if (event->captured) return cudaErrorCapturedEvent;
            if (!event->marker) return cudaErrorInvalidResourceHandle;
            if (!event->marker->reached) return cudaErrorNotReady;
        }
        *milliseconds = std::chrono::duration<float, std::milli>(end->marker->at - begin->marker->at).count();
        return cudaSuccess;
    });
}

cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode mode) {
    return call([&] { return begin_capture(stream, mode); });
}
cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
    return call([&] {
        if (!graph) return cudaErrorInvalidValue;
        *graph = nullptr;
        Nodes nodes;
        const cudaError_t error = end_capture(stream, nodes);
        if (!error) *graph = new CUgraph_st{std::move(nodes)};
        return error;
    });
}
cudaError_t cudaThreadExchangeStreamCaptureMode(cudaStreamCaptureMode* mode) {
    return call([&] {
        if (!mode || *mode < cudaStreamCaptureModeGlobal || *mode > cudaStreamCaptureModeRelaxed)
            return cudaErrorInvalidValue;
        std::swap(*mode, host_thread().capture_mode);
        return cudaSuccess;
    });
}
cudaError_t cudaStreamGetCaptureInfo(cudaStream_t handle, cudaStreamCaptureStatus* status, unsigned long long* id) {
    return with_stream(handle, [&](CUstream_st& stream) {
        if (!status) return cudaErrorInvalidValue;
        if (is_blocked(&stream)) return cudaErrorStreamCaptureImplicit;  // the capture stays valid
        *status = !stream.capture           ? cudaStreamCaptureStatusNone
                  : stream.capture->invalid ? cudaStreamCaptureStatusInvalidated
                                            : cudaStreamCaptureStatusActive;
        if (id && *status == cudaStreamCaptureStatusActive) *id = stream.capture->id;
        return cudaSuccess;
    });
}
cudaError_t cudaStreamIsCapturing(cudaStream_t handle, cudaStreamCaptureStatus* status) {
    return cudaStreamGetCaptureInfo(handle, status, nullptr);
}

cudaError_t cudaGraphGetNodes(cudaGraph_t graph, cudaGraphNode_t* nodes, std::size_t* count) {
    return call([&] {
        if (!graph || !count) return cudaErrorInvalidValue;
        if (nodes) return cudaErrorNotSupported;  // nodes have no handles, only their number is available
        *count = graph->nodes.size();
        return cudaSuccess;
    });
}
cudaError_t cudaGraphInstantiate(cudaGraphExec_t* executable, cudaGraph_t graph, unsigned long long) {
    return call([&] {
        if (!executable || !graph) return cudaErrorInvalidValue;
        ++graph_count().instantiated;
        graph_count().nodes = graph->nodes.size();
        graph_count().chain = longest_chain(graph->nodes);
        *executable = new CUgraphExec_st{std::make_shared<const Nodes>(graph->nodes)};
        return cudaSuccess;
    });
}
cudaError_t cudaGraphUpload(cudaGraphExec_t executable, cudaStream_t handle) {
    return with_stream(handle, [&](CUstream_st&) { return executable ? cudaSuccess : cudaErrorInvalidValue; });
}
cudaError_t cudaGraphLaunch(cudaGraphExec_t executable, cudaStream_t stream) {
    return call([&] {
        if (!executable) return cudaErrorInvalidValue;
        return enqueue(stream, {Work::Kind::graph, nullptr, [nodes = executable->nodes] { run_nodes(*nodes); }});
    });
}
cudaError_t cudaGraphExecUpdate(cudaGraphExec_t executable, cudaGraph_t graph, cudaGraphExecUpdateResultInfo* result) {
    return call([&] {
        if (!executable || !graph || !result) return cudaErrorInvalidValue;
        const Nodes &old = *executable->nodes, &fresh = graph->nodes;
        *result = {cudaGraphExecUpdateSuccess, nullptr, nullptr};
        if (old.size() != fresh.size()) result->result = cudaGraphExecUpdateErrorTopologyChanged;
        for (std::size_t i = 0; i < old.size() && !result->result; ++i) {
            if (old[i].after != fresh[i].after) result->result = cudaGraphExecUpdateErrorTopologyChanged;
            if (old[i].work.kind != fresh[i].work.kind) result->result = cudaGraphExecUpdateErrorNodeTypeChanged;
        }
        if (result->result) return cudaErrorGraphExecUpdateFailure;
        executable->nodes = std::make_shared<const Nodes>(fresh);
        return cudaSuccess;
    });
}
cudaError_t cudaGraphExecDestroy(cudaGraphExec_t executable) {
    return call([&] {
        if (!executable) return cudaErrorInvalidValue;
        if (const cudaError_t error = leave_capture_alone()) return error;
        delete executable;
        return cudaSuccess;
    });
}
cudaError_t cudaGraphDestroy(cudaGraph_t graph) {
    return call([&] {
        if (!graph) return cudaErrorInvalidValue;
        delete graph;
        return cudaSuccess;
    });
}
