mod budget;
mod mesh_error;
mod stopping;
