"""The page of `teleopdesign app`: a marimo notebook, also for `marimo edit ... -- --folder F`."""

import marimo

app = marimo.App(width="medium", app_title="teleopdesign")


@app.cell
def _():
    import marimo as mo

    from teleopdesign.app import blocks, export, files, logs, pages, server, views
    from teleopdesign.app.task import BackgroundTask, stop_running
    from teleopdesign.app.workbench import Workbench
    from teleopdesign.base.errors import TeleopDesignError
    from teleopdesign.block_cuts import BlockDiagnosis

    folder = server.folder(mo.cli_args().to_dict())
    among = server.effects(mo.cli_args().to_dict())
    return (
        BackgroundTask,
        BlockDiagnosis,
        TeleopDesignError,
        Workbench,
        among,
        blocks,
        export,
        files,
        folder,
        logs,
        mo,
        pages,
        stop_running,
        views,
    )


@app.cell
def _(mo):
    get_bench, set_bench = mo.state(None)
    get_task, set_task = mo.state(None)
    get_note, set_note = mo.state("")
    get_names, set_names = mo.state(0)
    return get_bench, get_names, get_note, get_task, set_bench, set_names, set_note, set_task


@app.cell
def _(TeleopDesignError, files, folder, mo, set_names, set_note):
    def keep(dropped):
        for file in dropped:
            try:
                name = files.keep_dropped(folder, file.name, file.contents)
            except TeleopDesignError as error:
                set_note(str(error))
            else:
                set_note(f"{name} is copied into the folder; its content stands below")
        set_names(lambda n: n + 1)

    kinds = f"Drop a log here, or choose one ({files.endings()})"
    drop = mo.ui.file(kind="area", multiple=True, on_change=keep, label=kinds)
    return (drop,)


@app.cell
def _(files, folder, get_names, mo):
    get_names()
    names = files.experiments_in(folder)
    choice = mo.ui.dropdown(options=names, value=files.newest(folder, names), label="Experiment")
    return choice, names


@app.cell
def _(BackgroundTask, among, blocks, choice, files, folder, mo, set_note, set_task):
    def start_opening(_):
        if choice.value is None:
            set_note("choose an experiment first")
            return
        path = files.resolve_inside(folder, choice.value)
        set_note("")
        set_task(
            BackgroundTask(
                f"opening {choice.value}",
                lambda say: blocks.open_experiment(path, among=among, progress=say),
            )
        )

    open_button = mo.ui.button(label="Open", on_click=start_opening, kind="success")
    return (open_button,)


@app.cell
def _(files, folder, get_names, mo):
    get_names()
    known_logs = files.logs_in(folder)
    log = mo.ui.dropdown(options=known_logs, value=files.newest(folder, known_logs), label="Log")
    return (log,)


@app.cell
def _(TeleopDesignError, folder, log, logs, views):
    columns, unreadable = (), ""
    if log.value is not None:
        try:
            columns = logs.columns_of(folder, log.value)
        except TeleopDesignError as error:
            unreadable = str(error)
    form = views.column_form(columns)
    return columns, form, unreadable


@app.cell
def _(TeleopDesignError, columns, folder, form, log, logs, views):
    understood, trouble = None, ""
    duration, proposed = 1.0, ((0.0, 0.7), (0.7, 1.0))
    if columns:
        try:
            understood = logs.preview(folder, log.value, form.value)
        except TeleopDesignError as error:
            trouble = str(error)
        else:
            duration, proposed = understood.survey.duration, understood.spans()
    fit_span, check_span = views.span_sliders(duration, proposed)
    return check_span, fit_span, trouble, understood


@app.cell
def _(
    TeleopDesignError,
    check_span,
    columns,
    drop,
    fit_span,
    folder,
    form,
    log,
    logs,
    mo,
    set_names,
    set_note,
    trouble,
    understood,
    unreadable,
    views,
):
    def make(shown, spans):
        try:
            made = logs.make_experiment(folder, shown, spans)
            set_note(logs.describe_made(folder, made))
        except TeleopDesignError as error:
            set_note(str(error))
        set_names(lambda n: n + 1)

    parts = [drop]
    if log.value is not None:
        parts.append(log)
    if columns:
        parts += views.log_parts(form, understood, trouble, (fit_span, check_span), make)
    elif unreadable:
        parts.append(mo.callout(unreadable, kind="warn"))
    log_view = mo.vstack(parts)
    return (log_view,)


@app.cell
def _(choice, folder, mo, names, open_button, views):
    mo.vstack(
        [
            mo.md(
                "# teleopdesign\n\nFind what a model or a diagram lacks, in a recording of it. "
                f"Folder: `{folder.name}`"
            ),
            views.place_side_by_side(choice, open_button)
            if names
            else mo.md("The folder has no experiment yet. Add a log:"),
        ]
    )
    return


@app.cell
def _(get_task, mo, set_note, set_task, stop_running):
    def stop(_):
        # the work ends at its next line of progress; the page need not wait for that
        note = stop_running(get_task())
        if note:
            set_note(note)
            set_task(None)

    task = get_task()
    pulse = mo.ui.refresh(default_interval="0.5s", options=["0.5s"]) if task is not None else None
    cancel = mo.ui.button(label="Cancel", on_click=stop, kind="warn")
    return cancel, pulse, task


@app.cell
def _(cancel, get_note, mo, pulse, set_bench, set_note, set_task, task, views):
    if task is None:
        shown = mo.callout(get_note(), kind="warn") if get_note() else mo.md("")
    elif task.done:
        if task.error:
            set_note(task.error)
        elif isinstance(task.result, str):
            set_note(task.result)
        else:
            set_bench(task.result)
        set_task(None)
        shown = mo.md("")
    else:
        pulse.value  # noqa: B018 - the cell runs again at each of its beats
        shown = views.place_side_by_side(mo.md(f"**{task.name}** … {task.progress}"), cancel, pulse)
    shown  # noqa: B018 - a cell shows its last line
    return


@app.cell
def _(log_view, mo, names):
    # nothing else to begin with: not hidden
    mo.accordion({"Add a log": log_view}) if names else log_view
    return


@app.cell
def _(get_bench, mo, names):
    mo.md("Open an experiment to begin." if names and get_bench() is None else "")
    return


@app.cell
def _(BlockDiagnosis, blocks, get_bench, mo, views):
    whole = get_bench()
    mo.stop(not isinstance(whole, BlockDiagnosis))
    views.begin_anew()
    block = mo.ui.dropdown(options=blocks.places(whole), value=blocks.EVERY, label="Block")
    return block, whole


@app.cell
def _(BackgroundTask, blocks, folder, mo, set_note, set_task, whole):
    def write_whole(_):
        set_note("")
        set_task(BackgroundTask("writing", lambda say: blocks.write_all(whole, folder, say)))

    whole_button = mo.ui.button(
        label="Write report, answer and picture", on_click=write_whole, kind="success"
    )
    return (whole_button,)


@app.cell
def _(block, views, whole, whole_button):
    views.block_view(whole, block, whole_button)
    return


@app.cell
def _(Workbench, get_bench, mo, pages, views):
    bench = get_bench()
    mo.stop(not isinstance(bench, Workbench))
    views.begin_anew()
    bodies = tuple(bench.model.bodies)
    body = mo.ui.dropdown(options=bodies, value=bodies[0], label="Body")
    uses = [u for u in ("check", "fit") if bench.search.whole.of(u)]
    use = mo.ui.dropdown(options=uses, value=uses[0], label="Records")
    rungs = pages.rung_options(bench)
    rung = mo.ui.dropdown(options=rungs, value=list(rungs)[-1], label="Model")
    return bench, body, rung, use


@app.cell
def _(BackgroundTask, TeleopDesignError, bench, mo, pages, set_bench, set_note, set_task):
    options = pages.candidate_options(bench)
    first = pages.supported_option(bench)
    candidate = mo.ui.dropdown(options=options, value=first, label="Candidate", searchable=True)

    def add(_):
        if candidate.value is None:
            set_note("Choose a candidate first: the records support none of them.")
            return
        try:
            set_bench(bench.add(*candidate.value))
            set_note("")
        except TeleopDesignError as error:
            set_note(str(error))

    def take_back(_):
        try:
            set_bench(bench.take_back())
            set_note("")
        except TeleopDesignError as error:
            set_note(str(error))

    add_button = mo.ui.button(
        label="Add", on_click=add, kind="success" if first else "neutral", disabled=not options
    )
    back_button = mo.ui.button(label="Take back", on_click=take_back, disabled=len(bench.rungs) < 2)
    rank_button = mo.ui.button(
        label="Look for what else is missing",
        on_click=lambda _: set_task(BackgroundTask("ranking the candidates", bench.rank)),
        disabled=bench.is_ranked,
    )
    all_button = mo.ui.button(
        label="Add all that the records support",
        on_click=lambda _: set_task(BackgroundTask("diagnosing", bench.go_on)),
    )
    return add_button, all_button, back_button, candidate, rank_button


@app.cell
def _(add_button, all_button, back_button, bench, candidate, rank_button, views):
    # shown by a cell before the charts: the new rung is on the page while they are drawn
    views.ladder_view(
        bench,
        candidate,
        {"add": add_button, "back": back_button, "rank": rank_button, "all": all_button},
    )
    return


@app.cell
def _(bench, body, rung, use, views):
    residual_view = views.residual_view(bench, body, use, rung)
    return (residual_view,)


@app.cell
def _(bench, mo, pages, views):
    views.begin_anew()
    several = list(pages.rung_options(bench).items())
    one_model = mo.ui.dropdown(options=dict(several), value=several[0][0], label="One model")
    other_model = mo.ui.dropdown(options=dict(several), value=several[-1][0], label="Another")
    return one_model, other_model


@app.cell
def _(bench, body, one_model, other_model, use, views):
    compare_view = views.compare_view(bench, (one_model, other_model), body, use)
    return (compare_view,)


@app.cell
def _(bench, mo, views):
    views.begin_anew()
    free = [n for n, v in bench.model.parameters.items() if not v.fixed and v.value]
    which = mo.ui.dropdown(options=free, value=free[0] if free else None, label="Parameter")
    return (which,)


@app.cell
def _(mo):
    factor = mo.ui.slider(
        start=0.5, stop=1.5, step=0.01, value=1.0, label="times its value", show_value=True
    )
    return (factor,)


@app.cell
def _(bench, body, factor, use, views, which):
    slider_view = views.slider_view(bench, which, factor, body, use)
    return (slider_view,)


@app.cell
def _(bench, mo, pages, views):
    left_view = mo.lazy(lambda: pages.what_is_left(bench), show_loading_indicator=True)
    next_view = mo.lazy(
        lambda: mo.plain_text(pages.next_experiment(bench)), show_loading_indicator=True
    )
    simulation_view = mo.lazy(lambda: views.simulation_view(bench), show_loading_indicator=True)
    return left_view, next_view, simulation_view


@app.cell
def _(bench, body, mo, views):
    design_view = mo.lazy(lambda: views.design_view(bench, body.value), show_loading_indicator=True)
    return (design_view,)


@app.cell
def _(BackgroundTask, bench, export, folder, mo, set_note, set_task, views):
    def write(_):
        set_note("")
        set_task(BackgroundTask("writing", lambda say: export.write_all(bench, folder, say)))

    write_button = mo.ui.button(
        label="Write report, answer, model and script", on_click=write, kind="success"
    )
    export_view = views.export_view(bench, write_button)
    return (export_view,)


@app.cell
def _(
    compare_view,
    design_view,
    export_view,
    left_view,
    mo,
    next_view,
    residual_view,
    simulation_view,
    slider_view,
):
    mo.ui.tabs(
        {
            "Residual": residual_view,
            "Compare": compare_view,
            "Parameters": slider_view,
            "Simulation": simulation_view,
            "What is left": left_view,
            "Next experiment": next_view,
            "Design": design_view,
            "Export": export_view,
        }
    )
    return


if __name__ == "__main__":
    app.run()
