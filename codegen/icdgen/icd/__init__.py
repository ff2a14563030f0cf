"""What an ICD is: reading, checking and the model that everything else is made from."""
