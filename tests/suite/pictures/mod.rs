//! Pictures, films, plots, and the files that hold them.

mod context;
mod diagrams;
mod export_files;
mod export_formats;
mod export_gif;
mod iterate_films;
mod lettering;
mod own_drawings;
mod plot_formulas;
mod plots;
mod rendering;
mod scene_pictures;
mod snapshots;
mod strips;
mod study_pictures;
mod videos;
mod views;
